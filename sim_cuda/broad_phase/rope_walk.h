#pragma once
// Stackless queries of a binary tree: each node has a rope to the node right of its subtree (Prokopenko &
// Lebrun-Grandie 2024). A query starts at the rope of its own leaf. It descends into nodes that it overlaps,
// and follows the ropes of others. It only visits nodes to the right, so each pair is found once (half
// traversal).
//
// Leaves are nodes 0 .. n-1 in any order; inner nodes are n .. 2n-2.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/morton_order.h"
#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/buffer.h"

namespace collidoscope {

/// 32 bytes: two loads from one sector on a GPU.
struct alignas(16) RopedNode {
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  float min[3];
  std::uint32_t child;  ///< left child; for a leaf, the id of its body
  float max[3];
  /// Escape index: next node if this subtree is skipped; none: there is no node to the right.
  std::uint32_t rope;

  SIM_HD Aabb box() const { return {Vector3f(min[0], min[1], min[2]), Vector3f(max[0], max[1], max[2])}; }
  SIM_HD void set_box(const Aabb& box) {
    for (int k = 0; k < 3; ++k) {
      min[k] = box.min[k];
      max[k] = box.max[k];
    }
  }
  SIM_HD friend bool overlap(const RopedNode& a, const RopedNode& b) {
    // Without branches: their outcome cannot be predicted.
    return (a.min[0] <= b.max[0]) & (b.min[0] <= a.max[0]) & (a.min[1] <= b.max[1]) & (b.min[1] <= a.max[1]) &
           (a.min[2] <= b.max[2]) & (b.min[2] <= a.max[2]);
  }
};
static_assert(sizeof(RopedNode) == 32);
inline constexpr std::uint32_t no_rope = RopedNode::none;

/// Numbers of the leaves.
enum class LeafOrder { any, left_to_right };

/// Implements BroadPhase::find_pairs for a tree over n bodies, in the stage "pairs".
void find_pairs_by_ropes(Executor& executor, const RopedNode* nodes, std::uint32_t n, LeafOrder order,
                         const PairSink& sink);
/// Implements BroadPhase::count_visits. Shared warp traversal visits the same nodes as one thread per query.
void count_visits_by_ropes(Executor& executor, const RopedNode* nodes, std::uint32_t n,
                           const VisitSink& sink);

/// Base class of broad phases with such a tree. They sort bodies by Morton keys and build nodes in update().
template <class Key>
class RopeTreeMethod : public BroadPhase {
 public:
  RopeTreeMethod(Executor& executor, LeafOrder leaf_order)
      : executor_(executor), leaf_order_(leaf_order), order_(executor), nodes_(executor, "tree nodes") {}

  void reserve(std::int64_t bodies) override {
    n_ = static_cast<std::uint32_t>(bodies);
    order_.reserve(bodies);
    nodes_.resize_discarding(n_ > 0 ? 2 * static_cast<std::size_t>(n_) - 1 : 0);
  }
  void find_pairs(const PairSink& sink) override {
    find_pairs_by_ropes(executor_, nodes_.data(), n_, leaf_order_, sink);
  }
  void count_visits(const VisitSink& sink) const override {
    count_visits_by_ropes(executor_, nodes_.data(), n_, sink);
  }
  std::int64_t tree_nodes() const override { return static_cast<std::int64_t>(nodes_.size()); }

 protected:
  Executor& executor_;
  const LeafOrder leaf_order_;
  std::uint32_t n_ = 0;
  MortonOrder<Key> order_;
  Buffer<RopedNode> nodes_;
};

}  // namespace collidoscope
