#pragma once
// World: one scene being simulated, with all its buffers, on one executor. Made from a Scene, stepped,
// measured, published, destroyed; owns everything it uses. Not thread-safe: one thread at a time.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/broad_phase/tree_quality.h"
#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/guard/finding.h"
#include "sim_cuda/measure/body_report.h"
#include "sim_cuda/measure/step_stats.h"
#include "sim_cuda/publish/publish.h"
#include "sim_cuda/run/body_states.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/solver/residual.h"
#include "sim_cuda/solver/solver_memory.h"

namespace collidoscope {

struct RunState;
struct FirstFound;

class World {
 public:
  /// At state 0, or, as adopt() does it, at `start`, whose bodies have the ids `ids` here. Throws InputError
  /// where the scene is not valid or the options name nothing known, MachineError where the machine lacks
  /// what was asked for (the line says what and how much), or where a step would take more than
  /// step_estimate.h allows. Throws Cancelled.
  World(const Scene& scene, const RunOptions& options, const RunState* start = nullptr,
        const BodyIds& ids = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  const Scene& scene() const;
  const InitialBodies& initial() const;  ///< bodies at state 0: radii, masses and meshes never change
  const RunOptions& options() const;     ///< as asked for
  int key_bits() const;                  ///< of the broad phase's Morton keys: 24, 30 or 63; 0: it has none
  Effects effects() const;
  int substeps() const;  ///< of a step: as set, or what "auto" has come to
  bool on_gpu() const;
  int gpu() const;                                      ///< CUDA's number of the device, -1 on the CPU
  std::string device_name() const;                      ///< "NVIDIA H200", or the CPU's own name
  std::int64_t allocated_bytes() const;                 ///< in the executor's memory space
  std::map<std::string, std::int64_t> buffers() const;  ///< the same by what it is for
  LaunchShape launch_shape() const;                     ///< what was asked for; zeros are "auto"

  /// Advances by `count` steps; returns when they are done (overflows grown and repeated).
  /// Odd-numbered steps run instrumented, even-numbered ones plain, so that times() knows both.
  ///
  /// Where guards look (scene/effects.h) and one finds something in a step, that step is never in the state.
  /// They pause: the world stands at the state before, bit for bit, and steps no more until it is dismissed
  /// or adopts a state. Or they freeze: the body is fixed where it was in the state before, and the step done
  /// again; all that it never touches goes on as if it had been well. One that no force moves anyway cannot
  /// be frozen, and pauses.
  ///
  /// Throws Cancelled where options().cancellation was requested, as detect() and all that detects do; only
  /// whole steps are in the state then. On the CPU the world goes on from there once the request is cleared;
  /// on a GPU the device is still at work, and the process is to end without waiting for it.
  void step(int count = 1);
  std::int64_t steps() const;
  double time() const;  ///< s that were simulated since state 0; NaN: not known (RunState)

  /// The last one since the start, adopt() or dismiss().
  const std::optional<Finding>& finding() const;
  bool paused() const;  ///< at the finding
  /// Bodies that are frozen, ascending, by ids of now. Other settings do not free them; a start at state 0
  /// does.
  const std::vector<std::uint32_t>& frozen() const;
  /// Goes on from the state that it stands at, and nobody looks any more.
  void dismiss();

  /// (B, T) for the steps from now on. Throws MachineError beyond the device's limits, and changes nothing
  /// then.
  void set_launch_shape(LaunchShape shape);
  /// Takes the state of all bodies that both worlds have, the step count, the ledgers of the walls and what a
  /// solver of the same kind remembers from `other`, whatever executor, precision or settings it has: how a
  /// running scene changes them. `ids` says which body of `other` is which; empty: ids are the same in both.
  /// Bodies that `other` lacks keep their initial state. With the same physical settings and bodies, the run
  /// goes on bit for bit as `other` would have.
  void adopt(World& other);
  void adopt(const RunState& other, const BodyIds& ids = {});
  /// Where the run stands; waits for the device.
  RunState state();

  /// One body, read from the device; `id` < N. Detects, so that contacts and path fit the current state.
  BodyReport inspect(std::uint32_t id);

  /// Sums, counts and penetration at the current state. Pairs and contacts are those of the last step; of the
  /// current state where this world has made no step since it took its state.
  StepStats measure();
  RunTimes times() const;
  /// times() without medians and percentiles, which need all samples: for every frame of a live run.
  RunTimes latest_times() const;

  /// One 64-bit hash of the state: equal exactly where all bodies are bitwise equal (-0 = 0, one NaN).
  std::uint64_t state_hash();
  BodyStates bodies();
  /// All overlapping pairs (i < j), ordered, of the last step or detect().
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs();

  /// Whether steps note the normal impulse of each contact: in publish(), inspect(), measure() and
  /// impulses(). Off at first, and then it costs nothing; never changes the state.
  void record_impulses(bool on);
  /// The contacts of the last step, by a, then b, each with the sum over the iterations: with `impulse`, of
  /// the last substep; with `soft_step`, of all of them, contacts that gave nothing among them. Empty where
  /// that step was not recorded.
  std::vector<ContactImpulse> impulses();

  /// Whether steps measure what each sweep of the solver left of its contacts' errors. Off at first, and then
  /// it costs nothing; never changes the state.
  void record_residuals(bool on);
  /// Of the last step, in the order of its sweeps; empty where that step was not recorded.
  std::vector<Residual> residuals();

  /// Finds boxes, tree, pairs and contacts of the *current* state without moving it, so that what is drawn
  /// fits the bodies. Changes no hash. publish(), pairs() and tree_levels() then speak of the current state.
  void detect();
  TreeLevels tree_levels();
  std::vector<std::int64_t> tree_level_sizes();  ///< boxes of each level, from the root; empty: no tree
  std::int64_t tree_nodes() const;               ///< in all
  /// Measures the tree of the current state, by sums over its nodes and a query of every body; once for each
  /// state. All zero where the method has no tree.
  const TreeQuality& tree_quality();
  /// Nodes of the tree, the greatest by `metric` first; of those of the levels `from` to `to` the ones from
  /// `first` on, at most `count`.
  std::vector<NodeReport> ranked_nodes(NodeMetric metric, std::int64_t first, std::int64_t count,
                                       int from = 0, int to = 63);
  NodeReport tree_node(std::uint32_t place);  ///< place < tree_nodes()
  /// At these places, each < tree_nodes().
  std::vector<NodeReport> tree_nodes_at(const std::vector<std::uint32_t>& places);
  /// Of the nodes in the selection's levels; `inside` counts those within its range, too.
  NodeSpread node_spread(NodeMetric metric, const NodeSelection& selection);
  /// Leaves at each level, without a measure of the tree.
  const std::vector<std::int64_t>& tree_leaves();
  /// Nodes that the method's own traversal reads for a query, on average: TreeQuality::own, without the rest
  /// of the measures. 0 where the method has no tree.
  double own_visits();
  /// The places of the nodes that the query of a body tests, in its order; the first `most`.
  std::vector<std::uint32_t> visited_nodes(std::uint32_t id, std::int64_t most);
  std::int64_t visits_of(std::uint32_t id);  ///< how many they are; 0 without a tree
  /// Finds the pairs of the current state `repeats` times, from positions to the ordered list, plain and then
  /// with a time taken after each stage; in ms. Moves nothing.
  BroadPhaseTimes time_broad_phase(int repeats);
  /// Of the tree of the current state: one and the same query for whatever method's tree, of every body;
  /// `repeats` times in ms. What is left of a method's own time is its layout and its traversal. No tree:
  /// none.
  std::vector<float> time_tree_queries(int repeats);
  std::int64_t broad_phase_bytes() const;  ///< of the method alone
  /// Of the current state, which it detects; contacts are the pairs that touch. An empty range: no boxes.
  PublishCounts publish_counts(int first_level, int last_level);
  /// Packs what is drawn into the target's memory; returns when the device has written it.
  void publish(const PublishTarget& target);
  /// How far each body is from where it should be, m, by id, as somebody who knows found out: what
  /// BodyColor::error shows from now on. Other than N of them: 0 for all.
  void set_errors(std::vector<float> errors);
  const std::vector<float>& errors() const;  ///< as they were set
  /// Memory in the executor's space for a renderer that cannot map its own: a device allocation on a GPU,
  /// else plain memory. Freed with the World.
  void* scratch(std::size_t bytes, int slot);
  /// Copies from the executor's memory space to the host.
  void copy_to_host(void* host, const void* source, std::size_t bytes);

 private:
  void resolve(const FirstFound& found, std::uint32_t first_run);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace collidoscope
