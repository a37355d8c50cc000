#pragma once
// Looks into the broad phase of a world: the tree of the current state, its measures, and how long the method
// takes. Detects where the boxes are not those of the current state (World::detect), and measures the tree
// once for each state. Changes no state and no hash.

#include <cstdint>
#include <vector>

#include "sim_cuda/broad_phase/tree_quality.h"
#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/measure/body_report.h"

namespace collidoscope {

class Simulation;

/// A part of World: World::tree().
class TreeProbe {
 public:
  explicit TreeProbe(Simulation& run) : run_(run) {}

  std::int64_t nodes() const;  ///< in all; 0: no tree
  TreeLevels levels();
  std::vector<std::int64_t> level_sizes();  ///< boxes of each level, from the root; empty: no tree
  /// Leaves at each level, without a measure of the tree.
  const std::vector<std::int64_t>& leaves();

  /// Measures the tree, by sums over its nodes and a query of every body. All zero where the method has no
  /// tree.
  const TreeQuality& quality();
  /// Nodes that the method's own traversal reads for a query, on average: TreeQuality::own, without the rest
  /// of the measures. 0 where the method has no tree.
  double own_visits();

  /// Nodes of the tree, the greatest by `metric` first; of those of the levels `from` to `to` the ones from
  /// `first` on, at most `count`.
  std::vector<NodeReport> ranked(NodeMetric metric, std::int64_t first, std::int64_t count, int from = 0,
                                 int to = 63);
  NodeReport node(std::uint32_t place);  ///< place < nodes()
  /// At these places, each < nodes().
  std::vector<NodeReport> nodes_at(const std::vector<std::uint32_t>& places);
  /// Of the nodes in the selection's levels; `inside` counts those within its range, too.
  NodeHistogram node_histogram(NodeMetric metric, const NodeSelection& selection);

  /// The places of the nodes that the query of a body tests, in its order; the first `most`.
  std::vector<std::uint32_t> visited(std::uint32_t id, std::int64_t most);
  std::int64_t visits_of(std::uint32_t id);  ///< how many they are; 0 without a tree

  /// Finds the pairs of the current state `repeats` times, from positions to the ordered list, plain and then
  /// with a time taken after each stage; in ms. Moves nothing.
  BroadPhaseTimes time_broad_phase(int repeats);
  /// Of the tree of the current state: one and the same query for the tree of every method, of every body;
  /// `repeats` times in ms. What remains of a method's own time is its layout and its traversal. No tree:
  /// none.
  std::vector<float> time_queries(int repeats);

 private:
  Simulation& run_;
};

}  // namespace collidoscope
