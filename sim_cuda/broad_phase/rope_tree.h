#pragma once
// A binary tree whose queries need no stack: each node has a rope to the node right of its subtree
// (Prokopenko & Lebrun-Grandie 2024). A query starts at its own leaf's rope and walks right, down into what
// it overlaps and along the ropes past what it does not, so that it finds each pair once (half traversal).
//
// Leaves are the nodes 0 .. n-1 in any order, inner nodes n .. 2n-2. Whoever builds the tree gives each pair
// of siblings its links; the ropes follow from these in one launch.

#include <cstdint>

#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/whole_record.h"

namespace collidoscope {

/// 32 bytes: a GPU reads it in two loads from one sector.
struct alignas(16) RopedNode {
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  float min[3];
  std::uint32_t child;  ///< the left one; of a leaf: the id of its body
  float max[3];
  std::uint32_t rope;  ///< none: nothing is to the right

  SIM_HD Aabb box() const { return {Vector3f(min[0], min[1], min[2]), Vector3f(max[0], max[1], max[2])}; }
  SIM_HD void set_box(const Aabb& box) {
    for (int k = 0; k < 3; ++k) {
      min[k] = box.min[k];
      max[k] = box.max[k];
    }
  }
  SIM_HD friend bool overlap(const RopedNode& a, const RopedNode& b) {
    return a.min[0] <= b.max[0] && b.min[0] <= a.max[0] && a.min[1] <= b.max[1] && b.min[1] <= a.max[1] &&
           a.min[2] <= b.max[2] && b.min[2] <= a.max[2];
  }
};
static_assert(sizeof(RopedNode) == 32);

/// The way up: a left child's link is its sibling, a right child's its parent, the root's `none`.
struct TreeLinks {
  static constexpr std::uint32_t none = RopedNode::none, upward = 1u << 31;
  std::uint32_t* link;

  SIM_HD void join(std::uint32_t left, std::uint32_t right, std::uint32_t parent) const {
    link[left] = right;
    link[right] = parent | upward;
  }
  SIM_HD bool is_root(std::uint32_t node) const { return link[node] == none; }
  SIM_HD bool is_left(std::uint32_t node) const { return !(link[node] & upward); }
  SIM_HD std::uint32_t parent(std::uint32_t node) const {
    return link[is_left(node) ? link[node] : node] & ~upward;
  }
};

/// A left child's rope leads to its sibling, a right one's where its parent's does.
struct TieRopes {
  TreeLinks links;
  RopedNode* nodes;
  SIM_HD void operator()(int item) const {
    std::uint32_t at = static_cast<std::uint32_t>(item);
    while (!links.is_root(at) && !links.is_left(at)) at = links.parent(at);
    nodes[item].rope = links.link[at];
  }
};

struct WalkRopes {
  const RopedNode* nodes;
  std::uint32_t n;
  PairSink sink;
  SIM_HD void operator()(int leaf) const {
    const RopedNode query = load_whole(&nodes[leaf]);
    PairBatch batch(sink, query.child);
    for (std::uint32_t at = query.rope; at != RopedNode::none;) {
      const RopedNode node = load_whole(&nodes[at]);
      const bool hit = overlap(query, node), is_leaf = at < n;
      if (hit && is_leaf) batch.add(node.child);
      at = hit && !is_leaf ? node.child : node.rope;
    }
    batch.finish();
  }
};

/// Leaves under each node; `leaves` starts with zeros.
struct CountLeaves {
  TreeLinks links;
  std::uint32_t* leaves;
  SIM_HD void operator()(int item) const {
    auto at = static_cast<std::uint32_t>(item);
    for (atomic_add(&leaves[at], 1); !links.is_root(at); atomic_add(&leaves[at], 1)) at = links.parent(at);
  }
};

/// Leaves get the numbers of their order from left to right.
struct NumberLeaves {
  TreeLinks links;
  const RopedNode* nodes;
  const std::uint32_t* leaves;
  std::uint32_t* number;
  SIM_HD void operator()(int item) const {
    std::uint32_t before = 0;
    for (auto at = static_cast<std::uint32_t>(item); !links.is_root(at); at = links.parent(at))
      if (!links.is_left(at)) before += leaves[nodes[links.parent(at)].child];
    number[item] = before;
  }
};

struct WriteRopeTree {
  TreeLinks links;
  const RopedNode* nodes;
  std::uint32_t n;
  const std::uint32_t* number;
  TreeSink sink;
  SIM_HD void operator()(int item) const {
    const auto node = static_cast<std::uint32_t>(item);
    const std::uint32_t to = node < n ? number[node] : node;
    sink.box[to] = nodes[node].box();
    sink.parent[to] = links.is_root(node) ? to : links.parent(node);
    if (node < n) sink.leaf_body[to] = nodes[node].child;
  }
};

#if !SIM_CUDA || defined(__CUDACC__)
/// BroadPhase::write_tree of such a tree over n >= 1 bodies.
inline void write_rope_tree(Executor& executor, std::uint32_t n, const RopedNode* nodes, TreeLinks links,
                            const TreeSink& sink) {
  const std::int64_t count = 2 * std::int64_t{n} - 1;
  Buffer<std::uint32_t> leaves(executor, "leaves of nodes"), number(executor, "numbers of leaves");
  leaves.resize_discarding(static_cast<std::size_t>(count));
  number.resize_discarding(n);
  leaves.fill_zero();
  executor.run("tree", n, CountLeaves{links, leaves.data()});
  executor.run("tree", n, NumberLeaves{links, nodes, leaves.data(), number.data()});
  executor.run("tree", count, WriteRopeTree{links, nodes, n, number.data(), sink});
  executor.synchronize();
}
#endif

}  // namespace collidoscope
