#pragma once
// World: one scene that is being simulated, with all its buffers, on one executor. Made from a Scene,
// stepped, measured, drawn, destroyed; owns everything it uses. Not thread-safe: one thread at a time.
//
// World itself makes steps and has the state of the run. The rest are parts of it, each in a header of run/:
//
//   validation() findings, whether the run is paused at one, which bodies are frozen (state_validation.h)
//   records()    impulses and residuals of contacts, recorded on request (contact_records.h)
//   tree()       the tree of the broad phase: boxes, measures, ranked nodes, query times (tree_probe.h)
//   publisher()  records for drawing, and the memory that a renderer needs (publisher.h)
//   info()       the device, and what the world takes of it (world_info.h)

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim_cuda/core/stage_times.h"
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
class Simulation;

class World {
 public:
  /// At state 0, or, as restore() does it, at `start`, whose bodies have the ids `ids` here. Throws
  /// InputError where the scene is not valid or the options name nothing known, MachineError where the
  /// machine lacks what was asked for (the line says what and how much), or where a step would take more than
  /// step_estimate.h allows. Throws Cancelled.
  World(const Scene& scene, const RunOptions& options, const RunState* start = nullptr,
        const BodyIdMap& ids = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  const Scene& scene() const;
  const InitialBodies& initial() const;  ///< bodies at state 0: radii, masses and meshes never change
  const RunOptions& options() const;     ///< as asked for
  Effects effects() const;
  int substeps() const;  ///< of a step: as set, or what "auto" has come to
  WorldInfo info() const;
  std::map<std::string, std::int64_t> buffers() const;  ///< WorldInfo::allocated_bytes by what it is for

  StateValidation& validation();
  const StateValidation& validation() const;
  ContactRecords& records();
  TreeProbe& tree();
  Publisher& publisher();

  /// Advances by `count` steps; returns when they are done (overflows grown and repeated). Stops before where
  /// guards pause the run (state_validation.h). Odd-numbered steps run instrumented, even-numbered ones
  /// plain, so that times() knows both.
  ///
  /// Throws Cancelled where options().cancellation was requested, as detect() and everything that detects do;
  /// only whole steps are in the state then. On the CPU the world goes on from there once the request is
  /// cleared; on a GPU the device is still at work, and the process is to end without waiting for it.
  void step(int count = 1);
  std::int64_t steps() const;
  double time() const;  ///< s that were simulated since state 0; NaN: not known (RunState)

  /// Where the run stands; waits for the device.
  RunState state();
  /// Takes the state of all bodies that both worlds have, the step count, the ledgers of the walls and what a
  /// solver of the same kind remembers from `other`, whatever executor, precision or settings it has: how a
  /// running scene changes them. `ids` says which body of `other` is which; empty: ids are the same in both.
  /// Bodies that `other` lacks keep their initial state. With the same physical settings and bodies, the run
  /// goes on bit for bit as `other` would have.
  void restore(World& other);
  void restore(const RunState& other, const BodyIdMap& ids = {});
  /// One 64-bit hash of the state: equal exactly where all bodies are bitwise equal (-0 = 0, one NaN).
  std::uint64_t state_hash();
  BodyStates bodies();

  /// Finds boxes, tree, pairs and contacts of the *current* state without moving it, so that what is drawn
  /// fits the bodies. Changes no hash.
  void detect();
  /// All overlapping pairs (i < j), ordered, of the last step or detect().
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs();
  /// Sums, counts and penetration at the current state. Pairs and contacts are those of the last step; of the
  /// current state where this world has made no step since it took its state.
  StepStats measure();
  /// One body, read from the device; `id` < N. Detects, so that contacts and path fit the current state.
  BodyReport inspect(std::uint32_t id);

  /// (B, T) for the steps from now on. Throws MachineError beyond the device's limits, and changes nothing
  /// then.
  void set_launch_shape(LaunchShape shape);
  LaunchShape launch_shape() const;  ///< what was asked for; zeros are "auto"
  RunTimes times() const;
  /// times() without medians and percentiles, which need all samples: for every frame of a live run.
  RunTimes latest_times() const;

 private:
  std::unique_ptr<Simulation> run_;
};

}  // namespace collidoscope
