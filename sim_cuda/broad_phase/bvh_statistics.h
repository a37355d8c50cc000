#pragma once
// Measures an arranged tree: sums over its nodes, and a query of every body that counts what it visits.
// Outside the step, on request. Owns the values per node and per body, for those who draw them.

#include <cstdint>
#include <vector>

#include "sim_cuda/broad_phase/tree.h"
#include "sim_cuda/broad_phase/tree_quality.h"
#include "sim_cuda/core/buffer.h"

namespace collidoscope {

/// Sums over nodes: areas (of leaves twice, for the test of what they hold), overlap and empty space of inner
/// nodes and their number, and of all sides, faces and volumes.
struct NodeSums {
  double area = 0, overlap = 0, empty = 0, sides = 0, faces = 0, volume = 0, inner = 0;
};
/// Sums over queries: powers of the half extent, areas, end point overlap, visits, and the leaves of other
/// bodies found to overlap, so each pair twice.
struct QuerySums {
  double q1 = 0, q2 = 0, q3 = 0, area = 0, epo = 0, visits = 0;
  std::int64_t overlaps = 0;
};

/// Least and greatest of values, where there are any.
struct ValueSpan {
  float least = 0, greatest = 0;
  std::uint32_t count = 0;
};

class BvhStatistics {
 public:
  explicit BvhStatistics(Executor& executor);

  /// Leaves at each level; without measure(), too.
  std::vector<std::int64_t> leaves(const TreeView& tree);
  /// All but `bytes` and `own`. Waits for the device.
  TreeQuality measure(const TreeView& tree, std::int64_t bodies);
  /// What the traversal of the method itself reads, whose boxes are those of its last update. Waits for the
  /// device.
  OwnVisits own_visits(const BroadPhase& method, std::int64_t bodies);
  /// After measure() of the same tree: enqueues one and the same query for whatever tree, of every body, from
  /// the root, along children, siblings and parents; for those who time it.
  void enqueue_queries(const TreeView& tree);
  /// After measure() of the same tree: of each node by its place, in the executor's memory.
  const float* values(NodeMetric metric) const;
  /// Of each body by its id: the boxes that its query tests.
  const std::uint32_t* body_visits() const { return body_visits_.data(); }
  std::int64_t visits_of(std::uint32_t body) const;

  /// After measure(): nodes of the levels `from` to `to` by a metric, the greatest first (by level: the
  /// deepest), ties by place; those from `first` on, at most `count`.
  std::vector<NodeReport> ranked(const TreeView& tree, NodeMetric metric, std::int64_t first,
                                 std::int64_t count, int from = 0, int to = 63);
  std::vector<NodeReport> nodes(const TreeView& tree, const std::vector<std::uint32_t>& places);
  NodeHistogram histogram(const TreeView& tree, NodeMetric metric, const NodeSelection& selection);
  /// The nodes that the query of a body tests, in its order; the first `limit`.
  std::vector<std::uint32_t> visited(const TreeView& tree, std::uint32_t body, std::int64_t limit);

 private:
  Executor& executor_;
  Buffer<float> level_, sah_share_, overlap_, empty_, visited_;  ///< by node
  Buffer<std::uint32_t> node_visits_;                            ///< by node
  Buffer<std::uint32_t> body_visits_;                            ///< by id
  Buffer<std::uint32_t> leaf_visits_, overlaps_, leaf_node_;     ///< by place in the tree's order
  Buffer<std::uint32_t> place_;                                  ///< by id
  Buffer<std::uint32_t> own_visits_;                             ///< by the items of the method's stage
  Buffer<std::uint64_t> shared_visits_;
  Buffer<double> epo_;  ///< by place
  Buffer<NodeSums> node_sums_;
  Buffer<QuerySums> query_sums_;
  Buffer<std::uint32_t> key_, sorted_key_, id_, order_;
  Buffer<ValueSpan> spans_;
  Buffer<float> edges_;
  Buffer<std::uint32_t> counts_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope
