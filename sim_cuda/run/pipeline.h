#pragma once
// The pipeline: the stages of one run, in order, over the buffers of one world. Each method only enqueues
// work on the executor, so that a run can be recorded once and replayed; step_runner.h decides when to run
// and grow. One interface for both precisions.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/guard/finding.h"
#include "sim_cuda/guard/stage_validator.h"
#include "sim_cuda/measure/body_report.h"
#include "sim_cuda/measure/step_stats.h"
#include "sim_cuda/publish/publish.h"
#include "sim_cuda/run/body_states.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/solver/residual.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

/// Capacities of the lists whose length the scene does not fix.
struct Capacity {
  std::int64_t pairs = 0, contacts = 0;
};

class Pipeline {
 public:
  virtual ~Pipeline() = default;

  /// Outside of runs; what runs have recorded must be recorded again afterwards.
  virtual void reserve(Capacity capacity) = 0;
  virtual Capacity capacity() const = 0;

  /// How many runs make a step: all substeps, or one, where the solver substeps within it.
  virtual int runs_per_step() const = 0;
  /// Enqueues one run: bounds, keys, sort, build, pairs, contacts, and what the solver makes of them.
  virtual void run() = 0;
  /// On the CPU, what each run calls once contacts are known, before it writes anything that outlives it.
  virtual void before_writing(std::function<void(const StepControl&)> callback) = 0;
  /// Enqueues bounds to contacts only: nothing moves.
  virtual void detect() = 0;
  /// Enqueues bounds to pairs only: from positions to the ordered list of pairs.
  virtual void find_pairs() = 0;

  /// Outside of runs; what runs have recorded must be recorded again afterwards.
  virtual void record_impulses(bool on) = 0;
  /// Puts the impulses of the last run aside, with its contacts: before detect() finds others.
  virtual void keep_impulses() = 0;
  virtual std::vector<ContactImpulse> impulses() = 0;  ///< what was kept last

  /// As ContactSolver has them.
  virtual void record_residuals(bool on) = 0;
  virtual std::vector<Residual> residuals() = 0;

  /// What guards have found since clear_violation(); waits for the device. Nothing where nobody looks.
  virtual std::optional<FirstViolation> first_violation() const = 0;
  virtual void clear_violation() = 0;
  /// Does the runs of a step up to the one in which this was found, `runs_before` of them, and that one, and
  /// reads it on its way. Waits for the device.
  virtual Finding describe_violation(const FirstViolation& found, int runs_before) = 0;
  /// From here on nobody looks; what runs have recorded must be recorded again.
  virtual void disable_guards() = 0;

  virtual StepControl control() = 0;  ///< read from the device; waits for it
  virtual void clear_overflow() = 0;
  virtual void set_counts(const StepControl& control) = 0;  ///< of the last committed run, as they are there
  /// The arrays that runs write and that outlive them: the state, and what is remembered of it.
  virtual void visit_persistent_arrays(const ArrayVisitor& visit) = 0;
  virtual BroadPhase& broad_phase() = 0;
  virtual std::int64_t broad_phase_bytes() const = 0;  ///< that the method took when it was made

  /// Energy, momenta and extremes at the current state; `contacts` must be those of the current state
  /// (detect()).
  virtual void measure(StepStats& stats) = 0;
  virtual std::uint64_t state_hash() = 0;
  virtual BodyStates bodies() = 0;
  virtual std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs() = 0;
  /// `errors`: m, by id, or null.
  virtual void publish(const PublishTarget& target, const TreeView& tree, const TreeValues& values,
                       const float* errors) = 0;

  virtual std::int64_t joints() const = 0;                   ///< that are simulated
  virtual std::vector<StaticImpulse> static_impulses() = 0;  ///< empty where there are no walls
  /// Overwrites the state of bodies 0 .. states.position.size()-1 (at most N), and their ledgers where both
  /// worlds have walls.
  virtual void set_bodies(const BodyStates& states, const std::vector<StaticImpulse>& static_impulses) = 0;
  /// What the solver remembers of the steps before, and the same of another world, put in its place.
  virtual WarmStart save_warm_start() = 0;
  virtual void load_warm_start(const WarmStart& warm_start) = 0;
  virtual BodyReport inspect(std::uint32_t id, const TreeView& tree) = 0;
};

/// Uploads the bodies; reserves nothing yet. `broad_phase`: a name of broad_phase_methods.h; `substeps` of a
/// step, whatever the scene says.
std::unique_ptr<Pipeline> make_pipeline(Executor& executor, const std::string& broad_phase,
                                        const Scene& scene, const InitialBodies& bodies, Effects effects,
                                        int substeps);

}  // namespace collidoscope
