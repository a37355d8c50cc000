#pragma once
// What World and its parts work on: the scene, the executor, the pipeline and where the run stands. Internal;
// programs include world.h.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sim_cuda/broad_phase/bvh_cache.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/run/contact_records.h"
#include "sim_cuda/run/pipeline.h"
#include "sim_cuda/run/publisher.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/run/state_validation.h"
#include "sim_cuda/run/step_runner.h"
#include "sim_cuda/run/step_undo.h"
#include "sim_cuda/run/tree_probe.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

class Simulation {
 public:
  /// `start`: the state that it starts from, or null.
  Simulation(const Scene& scene, const RunOptions& options, const RunState* start, const BodyIdMap& ids);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // As World has them.
  void step(int count);
  RunState state();
  void restore(const RunState& other, const BodyIdMap& ids = {});
  void detect();
  void set_launch_shape(LaunchShape shape);
  std::int64_t steps() const { return steps_; }
  double time() const;

  /// Whether a step of this world led to the current state.
  bool stepped() const { return stepped_; }
  /// The pipeline; after a cancelled step, once the state before it is restored. Throws Cancelled while it
  /// cannot be restored.
  Pipeline& pipeline();
  StepRunner& runner() { return runner_; }
  /// Makes the pipeline again, with the bodies that are frozen now. Where memory is lacking, nothing has
  /// changed.
  void replace_pipeline();
  BvhCache& bvh_cache() { return bvh_cache_; }
  /// The tree over the boxes of the last step or detect(). Built at the first call after each.
  const TreeView& level_ordered_tree() { return bvh_cache_.level_ordered(pipeline().broad_phase()); }
  void keep_impulses() { records.keep(); }

  const Scene scene;
  RunOptions options;  ///< as asked for
  const InitialBodies initial;
  Executor executor;  // before everything that lives on it
  const Effects effects;
  const int substeps;  ///< as the pipeline takes them
  ContactRecords records{*this};
  StateValidation validation;
  TreeProbe tree{*this};
  Publisher publisher{*this};

 private:
  /// A pipeline that has reserved nothing yet.
  std::unique_ptr<Pipeline> make();
  /// Puts the pipeline into this state, of which it has the frozen bodies already.
  void write_state(const RunState& state);
  /// Does one step; or returns what guards found in it. Then the step is not counted, and the state is
  /// undefined.
  std::optional<FirstViolation> advance();
  /// After a cancelled step: restores the state before it.
  void recover();

  StepUndo undo_;
  std::int64_t steps_ = 0;
  struct KnownTime {
    std::int64_t step = 0;
    double time = 0;  // s
  } known_time_;      // of a state from which on all steps are of the same length
  BvhCache bvh_cache_;
  bool detected_ = false;  // pairs and contacts are those of the current state
  bool stepped_ = false;
  StepRunner runner_;
};

}  // namespace collidoscope
