#pragma once
// Computes statistics of a level-ordered tree: sums over its nodes, and visit counts of one query per body.
// Used outside the step, on request. Owns the values per node and per body, which displays can read.

#include <cstdint>
#include <vector>

#include "sim_cuda/broad_phase/tree.h"
#include "sim_cuda/broad_phase/tree_quality.h"
#include "sim_cuda/core/buffer.h"

namespace collidoscope {

/// Sums over nodes. `area` counts leaves twice (for the test of their body). `overlap` and `empty` sum over
/// inner nodes, `inner` counts them. `sides`, `faces` and `volume` sum over all nodes.
struct NodeSums {
  double area = 0, overlap = 0, empty = 0, sides = 0, faces = 0, volume = 0, inner = 0;
};
/// Sums over queries: powers of the half extent, areas, end point overlap and visits. `pairs` counts
/// overlapping leaves of other bodies, so each pair twice.
struct QuerySums {
  double q1 = 0, q2 = 0, q3 = 0, area = 0, epo = 0, visits = 0;
  std::int64_t pairs = 0;
};

/// Minimum and maximum of `count` values; unused if `count` is 0.
struct ValueSpan {
  float least = 0, greatest = 0;
  std::uint32_t count = 0;
};

class BvhStatistics {
 public:
  explicit BvhStatistics(Executor& executor);

  /// Number of leaves per level. Does not require measure().
  std::vector<std::int64_t> leaves(const TreeView& tree);
  /// Returns all members except `bytes` and `own`. Waits for the device.
  TreeQuality measure(const TreeView& tree, std::int64_t bodies);
  /// Visits of the method's own traversal, for the boxes of its last update. Waits for the device.
  OwnVisits own_visits(const BroadPhase& method, std::int64_t bodies);
  /// Enqueues one query per body: from the root, without a stack. The traversal is the same for all trees;
  /// used for timing. Precondition: measure() of the same tree.
  void enqueue_queries(const TreeView& tree);
  /// Values by node, in the executor's memory. Precondition: measure() of the same tree.
  const float* values(NodeMetric metric) const;
  /// Box tests of each body's query, by id.
  const std::uint32_t* body_visits() const { return body_visits_.data(); }
  std::int64_t visits_of(std::uint32_t body) const;

  /// Nodes of the levels `from` to `to`, in descending order of a metric, ties by place. Returns at most
  /// `count` nodes, starting at rank `first`. Precondition: measure().
  std::vector<NodeReport> ranked(const TreeView& tree, NodeMetric metric, std::int64_t first,
                                 std::int64_t count, int from = 0, int to = 63);
  std::vector<NodeReport> nodes(const TreeView& tree, const std::vector<std::uint32_t>& places);
  NodeHistogram histogram(const TreeView& tree, NodeMetric metric, const NodeSelection& selection);
  /// The nodes that the query of a body tests, in order; at most `limit`.
  std::vector<std::uint32_t> visited(const TreeView& tree, std::uint32_t body, std::int64_t limit);

 private:
  Executor& executor_;
  Buffer<float> level_, sah_share_, overlap_, empty_, visited_;  ///< by node
  Buffer<std::uint32_t> node_visits_;                            ///< by node
  Buffer<std::uint32_t> body_visits_;                            ///< by id
  Buffer<std::uint32_t> leaf_visits_, overlaps_, leaf_node_;     ///< by place in tree order
  Buffer<std::uint32_t> place_;                                  ///< by id
  Buffer<std::uint32_t> own_visits_;                             ///< by item of the method's stage
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
