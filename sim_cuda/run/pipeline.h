#pragma once
// The pipeline: the stages of one run, in order, over the buffers of one world. Stage methods only enqueue
// work on the executor, so a run can be recorded once and replayed. step_runner.h decides when to run and
// to grow lists. One interface for both precisions.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/core/state_hashes.h"
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

/// Capacities of the lists of variable length.
struct Capacity {
  std::int64_t pairs = 0, contacts = 0;
};

class Pipeline {
 public:
  virtual ~Pipeline() = default;

  /// Sets the capacities. Call outside of runs; runs must be recorded again afterwards.
  virtual void reserve(Capacity capacity) = 0;
  virtual Capacity capacity() const = 0;

  /// Runs per step: one, or the number of substeps if the solver has no substeps within a run.
  virtual int runs_per_step() const = 0;
  /// Enqueues one run: bounds, keys, sort, build, pairs, contacts, and the stages of the solver.
  virtual void run() = 0;
  /// Sets a callback for CPU runs. It is called after contacts are found, before persistent arrays are
  /// written.
  virtual void before_writing(std::function<void(const StepControl&)> callback) = 0;
  /// Enqueues bounds to contacts only; does not move bodies.
  virtual void detect() = 0;
  /// Enqueues bounds to pairs only: from positions to the sorted list of pairs.
  virtual void find_pairs() = 0;

  /// Call outside of runs; runs must be recorded again afterwards.
  virtual void record_impulses(bool on) = 0;
  /// Keeps the impulses of the last run with its contacts. Call before detect() replaces the contacts.
  virtual void keep_impulses() = 0;
  virtual std::vector<ContactImpulse> impulses() = 0;  ///< impulses of the last keep_impulses()

  /// See ContactSolver.
  virtual void record_residuals(bool on) = 0;
  virtual std::vector<Residual> residuals() = 0;

  /// First violation since clear_violation(); waits for the device. Empty without guards.
  virtual std::optional<FirstViolation> first_violation() const = 0;
  virtual void clear_violation() = 0;
  /// Repeats the runs of a step up to the violation (`runs_before` runs, then the run with the violation)
  /// and reads it. Waits for the device.
  virtual Finding describe_violation(const FirstViolation& found, int runs_before) = 0;
  /// Disables guards from now on; runs must be recorded again.
  virtual void disable_guards() = 0;

  virtual StepControl control() = 0;  ///< copy of the device's values; waits for the device
  virtual void clear_overflow() = 0;
  virtual void set_counts(const StepControl& control) = 0;  ///< sets the counts of the last committed run
  /// Visits the persistent arrays that runs write: the state and the warm-start data.
  virtual void visit_persistent_arrays(const ArrayVisitor& visit) = 0;
  virtual BroadPhase& broad_phase() = 0;
  /// The tree to show: that of the broad phase, or the tree of another program over the boxes of the scene.
  virtual BroadPhase& tree_source() = 0;
  virtual std::int64_t broad_phase_bytes() const = 0;  ///< allocated by the method at its creation

  /// Measures energy, momenta and maxima at the current state. Precondition: the contacts are those of the
  /// current state (detect()).
  virtual void measure(StepStats& stats) = 0;
  virtual std::uint64_t state_hash() = 0;
  virtual StateHashes hashes() = 0;
  /// Each further run computes the hashes of the state after it (StepControl::hash_sums). Runs must be
  /// recorded again afterwards.
  virtual void record_hashes(bool on) = 0;
  /// Copies the state of the bodies to the host; waits for the device.
  virtual void save_bodies(DeferredParts<BodyStates>& parts) = 0;
  BodyStates bodies();
  virtual std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs() = 0;
  /// `errors`: by id, m; null: none.
  virtual void publish(const PublishTarget& target, const TreeView& tree, const TreeValues& values,
                       const float* errors) = 0;

  virtual std::int64_t joints() const = 0;                   ///< number of simulated joints
  virtual std::vector<StaticImpulse> static_impulses() = 0;  ///< empty without walls
  /// Overwrites the state of bodies 0 to states.position.size() - 1 (at most N). Also sets their static
  /// impulses if both worlds have walls.
  virtual void set_bodies(const BodyStates& states, const std::vector<StaticImpulse>& static_impulses) = 0;
  /// Warm-start data of the solver; load replaces them by those of another world.
  virtual void save_warm_start(WarmStartParts& parts) = 0;
  virtual void load_warm_start(const WarmStart& warm_start) = 0;
  virtual BodyReport inspect(std::uint32_t id, const TreeView& tree) = 0;
};

/// Creates a pipeline and uploads the bodies, without capacity for pairs and contacts. `broad_phase`: a
/// name of broad_phase_methods.h. `substeps`: per step; overrides the scene.
std::unique_ptr<Pipeline> make_pipeline(Executor& executor, const std::string& broad_phase,
                                        const Scene& scene, const InitialBodies& bodies, Effects effects,
                                        int substeps);

}  // namespace collidoscope
