#pragma once
// World: a simulated scene with all its buffers on one executor. Created from a Scene; owns everything it
// uses. Not thread-safe: use it from one thread at a time. SI units.
//
// World makes steps and owns the state of the run. Its parts have their own headers in run/:
//
//   validation() findings of guards, pause, and frozen bodies (state_validation.h)
//   records()    optional recording of contact impulses and residuals (contact_records.h)
//   tree()       tree of the broad phase: boxes, measures, ranked nodes, query times (tree_probe.h)
//   publisher()  draw records (publisher.h)
//   info()       device and memory use (world_info.h)

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim_cuda/broad_phase/pair_check.h"
#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/core/state_hashes.h"
#include "sim_cuda/measure/body_report.h"
#include "sim_cuda/measure/step_stats.h"
#include "sim_cuda/run/body_states.h"
#include "sim_cuda/run/contact_records.h"
#include "sim_cuda/run/publisher.h"
#include "sim_cuda/run/state_validation.h"
#include "sim_cuda/run/tree_probe.h"
#include "sim_cuda/run/world_info.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

struct RunState;
struct CopiedRunState;
class Simulation;

class World {
 public:
  /// Starts at state 0, or at `start`, as by restore(); `ids` maps the bodies of `start` to ids here.
  /// Throws InputError if the scene is invalid or an option is unknown. Throws MachineError if a required
  /// device or resource is missing, or if a step exceeds the limits of step_estimate.h. Its line states
  /// what is missing and how much. Throws Cancelled.
  World(const Scene& scene, const RunOptions& options, const RunState* start = nullptr,
        const BodyIdMap& ids = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  const Scene& scene() const;
  const InitialBodies& initial() const;  ///< bodies at state 0; radii, masses and meshes never change
  const RunOptions& options() const;     ///< as passed to the constructor
  Effects effects() const;
  int substeps() const;  ///< per step: the set value, or the result of "auto"
  /// Substeps that joints call for if "auto" does not give so many; otherwise 0.
  double substeps_missed() const;
  WorldInfo info() const;
  TuningConditions tuning_conditions() const;  ///< what the fastest launch shapes of this run depend on
  std::map<std::string, std::int64_t> buffers() const;  ///< WorldInfo::allocated_bytes by buffer name

  StateValidation& validation();
  const StateValidation& validation() const;
  ContactRecords& records();
  TreeProbe& tree();
  Publisher& publisher();

  /// Makes `count` steps and waits for them. Lists that overflow grow, and the step is repeated. Stops
  /// early if guards pause the run (state_validation.h). Odd-numbered steps are timed by stage,
  /// even-numbered steps as a whole; times() has both.
  ///
  /// Throws Cancelled if options().cancellation is requested, as do detect() and all functions that call
  /// it. The state then contains only complete steps. On the CPU, the world can continue after the request
  /// is cleared; on a GPU, only if the request was one between steps (cancellation.h). Otherwise work is
  /// still in progress there, and the process should exit without waiting for it.
  void step(int count = 1);
  std::int64_t steps() const;
  double time() const;  ///< simulated time since state 0, s; NaN: unknown (RunState)

  /// Copies the state of the run to the host; waits for the device.
  RunState state();
  /// state() in two parts: the second one, CopiedRunState::complete(), may run on another thread.
  CopiedRunState copy_state();
  /// Takes over the state of another world, for example after a change of settings. Copies the state of
  /// common bodies, the step count, the static impulses, and the warm-start data of a solver of the same
  /// kind. Executor, precision and settings may differ.
  ///
  /// `ids`: id here of each body of `other`; empty: the same ids. Bodies that are not in `other` keep their
  /// initial state. With the same physical settings and bodies, the run continues bit for bit as `other`
  /// would.
  void restore(World& other);
  void restore(const RunState& other, const BodyIdMap& ids = {});
  /// Marks the current state. rewind() returns to it, without copies through the host. It returns false and
  /// changes nothing if no state is marked; restore(), a cancelled step and guards that freeze bodies remove
  /// the mark.
  void mark();
  bool rewind();
  /// 64-bit hash of the state. Equal exactly if all bodies are bitwise equal (-0 = 0; all NaN are equal),
  /// apart from hash collisions.
  std::uint64_t state_hash();
  /// state_hash(), and a hash that also contains warm-start data, sleep timers, what float angular velocities
  /// lack (dynamics/wide_spin.h), and the sums of impulses. Waits for the device.
  StateHashes hashes();
  BodyStates bodies();

  /// Finds boxes, tree, pairs and contacts of the current state without moving bodies, so that drawn
  /// contacts match the bodies. Does not change the hash.
  void detect();
  /// Overlapping pairs (i < j) of the last step or detect(), sorted.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs();
  /// What was found about the pairs of a plug-in; unset for built-in broad phases.
  std::optional<PairCheck> pair_check();
  /// Measures the current state. Pairs and contacts are those of the last step. Before the first step of
  /// this world, they are those of the current state.
  StepStats measure();
  /// Reads one body from the device. Precondition: `id` < N; throws std::out_of_range otherwise. Calls
  /// detect(), so contacts and path match the current state.
  BodyReport inspect(std::uint32_t id);

  /// Sets (B, T) for the following steps. Throws MachineError beyond the device's limits; nothing changes
  /// then.
  void set_launch_shape(LaunchShape shape);
  LaunchShape launch_shape() const;  ///< as set; 0: automatic
  /// Sets (B, T) of single stages, instead of launch_shape(). step() throws InputError if there is no stage
  /// of such a name.
  void set_stage_shapes(const StageShapes& by_stage);
  RunTimes times() const;
  /// times() without medians and percentiles, which are slow. For each frame of a live run.
  RunTimes latest_times() const;

 private:
  std::unique_ptr<Simulation> run_;
};

}  // namespace collidoscope
