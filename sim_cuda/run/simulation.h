#pragma once
// Implementation of World and its parts: scene, executor, pipeline and run state. Lives as long as its
// World. Internal; programs include world.h.

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
#include "sim_cuda/run/state_mark.h"
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
  /// `start`: initial state, or null.
  Simulation(const Scene& scene, const RunOptions& options, const RunState* start, const BodyIdMap& ids);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // See World.
  void step(int count);
  CopiedRunState copy_state();
  RunState state() { return copy_state().complete(); }
  void restore(const RunState& other, const BodyIdMap& ids = {});
  void mark();
  bool rewind();
  void detect();
  void set_launch_shapes(LaunchShape shape, const StageShapes& by_stage);
  std::int64_t steps() const { return steps_; }
  /// What the fastest launch shapes of this run depend on.
  TuningConditions tuning_conditions() const;
  const TunedChoice& tuned() const { return tuned_; }
  /// Throws InputError if RunOptions::stage_shapes names a stage that the steps so far do not have.
  void require_known_stages();
  double time() const;

  /// True if the current state is the result of a step of this world.
  bool stepped() const { return stepped_; }
  /// The pipeline. After a cancelled step, restores the state before it first. Throws Cancelled if that is
  /// not possible yet.
  Pipeline& pipeline();
  StepRunner& runner() { return runner_; }
  /// Creates the pipeline again with the current frozen bodies. If memory is insufficient, nothing changes.
  void replace_pipeline();
  BvhCache& bvh_cache() { return bvh_cache_; }
  /// Tree over the boxes of the last step or detect(). Cached until the next of them.
  const TreeView& level_ordered_tree() { return bvh_cache_.level_ordered(pipeline().tree_source()); }
  void keep_impulses() { records.keep(); }

  const Scene scene;
  RunOptions options;  ///< as passed to the constructor
  const InitialBodies initial;
  Executor executor;  // declared before all members that use it
  const Effects effects;
  const int substeps;            ///< substeps per step in the pipeline
  const double substeps_missed;  ///< see joint_substeps.h
  ContactRecords records{*this};
  StateValidation validation;
  TreeProbe tree{*this};
  Publisher publisher{*this};

 private:
  /// Creates a pipeline without capacity.
  std::unique_ptr<Pipeline> make();
  /// Writes a state into the pipeline. Precondition: the pipeline has the frozen bodies of the state.
  void write_state(const RunState& state);
  /// Makes one step. If guards find a violation, returns it; the step is then not counted and the state is
  /// undefined.
  std::optional<FirstViolation> advance();
  /// Restores the state before a cancelled step, if there was one.
  void recover();
  /// Passes shapes to the executor; if they are automatic, tuned ones. Throws as Executor::set_shapes().
  void apply_shapes(LaunchShape shape, const StageShapes& by_stage);

  TunedChoice tuned_;
  StepUndo undo_;
  std::int64_t steps_ = 0;
  struct KnownTime {
    std::int64_t step = 0;
    double time = 0;  // s
  } known_time_;      // of a state after which all steps have the same length
  StateMark mark_;
  struct Marked {
    std::int64_t steps = 0;
    KnownTime known_time;
  } marked_;
  BvhCache bvh_cache_;
  bool detected_ = false;  // pairs and contacts are those of the current state
  bool stepped_ = false;
  bool knows_stages_ = false;  // require_known_stages() has passed
  StepRunner runner_;
};

}  // namespace collidoscope
