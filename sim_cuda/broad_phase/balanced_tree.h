#pragma once
// A balanced tree over n places, split level by level; used by the k-d tree and the BSP. Node i of level L
// covers the places floor(i n / 2^L) to floor((i + 1) n / 2^L) - 1. Its shape depends on n only, and needs no
// memory. Each method defines the order of the bodies, and the splitting planes of inner nodes. Inner nodes
// have heap indices: the root is 1, the children of h are 2h and 2h + 1.

#include <bit>
#include <cstdint>

#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/vector_load.h"

namespace collidoscope {

/// Places of an inner node: first .. middle - 1 are its left child, middle .. end - 1 its right child.
struct NodeRange {
  std::uint32_t first, middle, end;
  SIM_HD bool inner() const { return end - first > 1; }
};

struct BalancedTree {
  static constexpr int max_levels = 27;  // 2^27 bodies

  std::uint32_t n = 0;
  int levels = 0;  ///< inner levels: the smallest with 2^levels >= n. The last one may contain leaves

  BalancedTree() = default;
  explicit BalancedTree(std::int64_t places) : n(static_cast<std::uint32_t>(places)) {
    while (std::int64_t{1} << levels < places) ++levels;
  }
  std::size_t heap_size() const { return n > 1 ? std::size_t{1} << levels : 0; }

  SIM_HD std::uint32_t begin(int level, std::uint32_t node) const {
    return static_cast<std::uint32_t>(std::uint64_t{node} * n >> level);
  }
  SIM_HD NodeRange range(int level, std::uint32_t node) const {
    return {begin(level, node), begin(level + 1, 2 * node + 1), begin(level, node + 1)};
  }
  /// The node of a level that contains a place.
  SIM_HD std::uint32_t node_at(int level, std::uint32_t place) const {
    return static_cast<std::uint32_t>((((std::uint64_t{place} + 1) << level) - 1) / n);
  }
  SIM_HD static std::uint32_t heap(int level, std::uint32_t node) { return (1u << level) + node; }

  /// Node number for TreeSink. The inner node that splits after place k has the number n + k.
  SIM_HD std::uint32_t number(const NodeRange& node) const {
    return node.inner() ? n + node.middle - 1 : node.first;
  }
};

/// First place of a node's right child, and flags for children that are leaves.
struct SplitPosition {
  std::uint32_t bits;
  SplitPosition() = default;
  SIM_HD explicit SplitPosition(const NodeRange& h)
      : bits(h.middle | (h.middle - h.first == 1 ? 1u << 31 : 0u) | (h.end - h.middle == 1 ? 1u << 30 : 0u)) {
  }
  SIM_HD std::uint32_t middle() const { return bits & ((1u << 30) - 1); }
  SIM_HD bool left_is_leaf() const { return bits >> 31 & 1; }
  SIM_HD bool right_is_leaf() const { return bits >> 30 & 1; }
};

struct alignas(16) BalancedLeaf {
  float min[3];
  std::uint32_t body;
  float max[3];
  std::uint32_t unused;

  SIM_HD friend bool overlap(const BalancedLeaf& a, const BalancedLeaf& b) {
    return a.min[0] <= b.max[0] && b.min[0] <= a.max[0] && a.min[1] <= b.max[1] && b.min[1] <= a.max[1] &&
           a.min[2] <= b.max[2] && b.min[2] <= a.max[2];
  }
  SIM_HD Aabb box() const { return {Vector3f(min[0], min[1], min[2]), Vector3f(max[0], max[1], max[2])}; }
};
static_assert(sizeof(BalancedLeaf) == 32);

struct MakeBalancedLeaves {
  const Aabb* boxes;
  const std::uint32_t* order;
  BalancedLeaf* leaves;
  SIM_HD void operator()(int place) const {
    const Aabb box = boxes[order[place]];
    BalancedLeaf leaf;
    for (int k = 0; k < 3; ++k) {
      leaf.min[k] = box.min[k];
      leaf.max[k] = box.max[k];
    }
    leaf.body = order[place];
    leaf.unused = 0;
    store_vectorized(&leaves[place], leaf);
  }
};

/// The coordinate of a box for splitting: its centre; the origin for an empty box.
SIM_HD inline float center_of(const Aabb& box, int axis) {
  return is_empty(box) ? 0.0f : 0.5f * box.min[axis] + 0.5f * box.max[axis];
}

/// Order-preserving conversion of floats to integers, and its inverse.
SIM_HD inline std::uint32_t ordered_bits(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return bits ^ (bits >> 31 ? ~0u : 1u << 31);
}
SIM_HD inline float from_ordered_bits(std::uint32_t bits) {
  return std::bit_cast<float>(bits ^ (bits >> 31 ? 1u << 31 : ~0u));
}

/// Whether a box may overlap the children of a node.
struct ChildOverlap {
  bool left, right;
};

/// One body's query, from the root with a stack. Half traversal: only leaves to the right of the body's own
/// leaf are reported, so each pair is found once. Node: `SplitPosition split`, `ChildOverlap
/// overlapping_children(const BalancedLeaf&) const`.
template <class Node, class Sink>
struct TraverseBalanced {
  const Node* nodes;
  const BalancedLeaf* leaves;
  std::uint32_t n;
  Sink sink;

  SIM_HD void operator()(int item) const {
    const auto place = static_cast<std::uint32_t>(item);
    const BalancedLeaf query = load_readonly(&leaves[place]);
    auto batch = start_query(sink, item, query.body);
    // A node is popped before its children are pushed. So the stack holds at most one entry per level, plus
    // one.
    std::uint32_t stack[BalancedTree::max_levels + 1];
    int depth = 0;
    if (place + 1 < n) stack[depth++] = 1;
    while (depth > 0) {
      const std::uint32_t at = stack[--depth];
      const Node node = load_readonly(&nodes[at]);
      batch.visit();
      const ChildOverlap overlaps = node.overlapping_children(query);
      const std::uint32_t middle = node.split.middle();
      if (overlaps.left && middle > place + 1) {
        if (node.split.left_is_leaf())
          test_leaf(query, middle - 1, batch);
        else
          stack[depth++] = 2 * at;
      }
      if (overlaps.right) {  // the last place of this child is the node's last place, which is to the right
        if (node.split.right_is_leaf())
          test_leaf(query, middle, batch);
        else
          stack[depth++] = 2 * at + 1;
      }
    }
    batch.finish();
  }
  template <class Batch>
  SIM_HD void test_leaf(const BalancedLeaf& query, std::uint32_t place, Batch& batch) const {
    const BalancedLeaf other = load_readonly(&leaves[place]);
    batch.visit();
    if (overlap(query, other)) batch.add(other.body);
  }
};

}  // namespace collidoscope
