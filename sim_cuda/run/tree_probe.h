#pragma once
// Inspection of the broad phase of a world: tree, measures, and times at the current state. Calls
// World::detect() if the boxes are not those of the current state. The tree is measured once per state.
// Does not change the state or the hash.

#include <cstdint>
#include <vector>

#include "sim_cuda/broad_phase/tree_quality.h"
#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/measure/body_report.h"

namespace collidoscope {

class Simulation;

/// Part of World: World::tree().
class TreeProbe {
 public:
  explicit TreeProbe(Simulation& run) : run_(run) {}

  std::int64_t nodes() const;  ///< number of nodes; 0: no tree
  TreeLevels levels();
  std::vector<std::int64_t> level_sizes();  ///< boxes per level, from the root; empty: no tree
  /// Leaves per level; does not measure the tree.
  const std::vector<std::int64_t>& leaves();

  /// Measures the tree by sums over its nodes and one query per body. All zero if the method has no tree.
  const TreeQuality& quality();
  /// Mean number of nodes per query that the method's own traversal reads (TreeQuality::own). Does not
  /// compute the other measures. 0 if the method has no tree.
  double own_visits();

  /// Nodes of levels `from` to `to`, in descending order of `metric`. Returns at most `count` nodes, from
  /// index `first`.
  std::vector<NodeReport> ranked(NodeMetric metric, std::int64_t first, std::int64_t count, int from = 0,
                                 int to = 63);
  NodeReport node(std::uint32_t place);  ///< Precondition: place < nodes(). Throws std::out_of_range.
  /// Precondition: each place < nodes(). Throws std::out_of_range.
  std::vector<NodeReport> nodes_at(const std::vector<std::uint32_t>& places);
  /// Histogram over the nodes in the selected levels; `inside` counts those in the selected range.
  NodeHistogram node_histogram(NodeMetric metric, const NodeSelection& selection);

  /// Nodes that the query of a body tests, in order; at most `limit`.
  std::vector<std::uint32_t> visited(std::uint32_t id, std::int64_t limit);
  std::int64_t visits_of(std::uint32_t id);  ///< number of these nodes; 0 without a tree

  /// Finds the pairs of the current state `repeats` times from positions to the sorted list: without stage
  /// timing, then with it; in ms. Does not move bodies.
  BroadPhaseTimes time_broad_phase(int repeats);
  /// Times the same query of every body in the current tree, for any method; `repeats` times, in ms. The
  /// difference to a method's own time is due to its layout and traversal. Empty without a tree.
  std::vector<float> time_queries(int repeats);

 private:
  Simulation& run_;
};

}  // namespace collidoscope
