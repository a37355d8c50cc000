#pragma once
// Ropes (escape indices, rope_walk.h) for trees that are not built from left to right. The builder links each
// pair of siblings. One launch derives the ropes from the links. write_tree() uses the links, too.

#include <cstdint>

#include "sim_cuda/broad_phase/rope_walk.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/buffer.h"

namespace collidoscope {

/// Links towards the root. A left child links to its sibling, a right child to its parent; the root has
/// `none`.
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

/// The rope of a left child is its sibling; that of a right child is the rope of its parent.
struct SetEscapeIndices {
  TreeLinks links;
  RopedNode* nodes;
  SIM_HD void operator()(int item) const {
    std::uint32_t at = static_cast<std::uint32_t>(item);
    while (!links.is_root(at) && !links.is_left(at)) at = links.parent(at);
    nodes[item].rope = links.link[at];
  }
};

/// Counts the leaves below each node. `leaves` must be 0 initially.
struct CountLeaves {
  TreeLinks links;
  std::uint32_t* leaves;
  SIM_HD void operator()(int item) const {
    auto at = static_cast<std::uint32_t>(item);
    for (atomic_add(&leaves[at], 1); !links.is_root(at); atomic_add(&leaves[at], 1)) at = links.parent(at);
  }
};

/// Numbers the leaves from left to right.
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
/// Implements BroadPhase::write_tree for a tree over n >= 1 bodies.
inline void write_rope_tree(Executor& executor, std::uint32_t n, const RopedNode* nodes, TreeLinks links,
                            const TreeSink& sink) {
  const std::int64_t count = 2 * std::int64_t{n} - 1;
  Buffer<std::uint32_t> leaves(executor, "node leaves"), number(executor, "leaf numbers");
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
