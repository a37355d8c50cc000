#pragma once
// Common form of all hierarchies, for display, statistics and lookup of bodies. Built outside the step, on
// request. Within a step, each method uses its own layout.
//
// Nodes are in level order, the root first, and from left to right within a level. A level is therefore a
// contiguous range, and the children of a node are adjacent in the next level. Every body is a leaf, at any
// depth. Level 63 contains all nodes of depth 63 or more, in the same order; such deep trees are rare, and
// degenerate to lists.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/buffer.h"

namespace collidoscope {

class BroadPhase;
struct GivenTree;

/// Output of BroadPhase::write_tree for n bodies, in the executor's memory. Leaves have the numbers 0 .. n-1
/// from left to right; inner nodes follow in any order.
struct TreeSink {
  Aabb* box;
  std::uint32_t* parent;     ///< the root is its own parent
  std::uint32_t* leaf_body;  ///< leaves only: id of the body
};

/// Copies a tree to the sink.
void write_given_tree(Executor& executor, const GivenTree& tree, const TreeSink& sink);

/// A tree in level order, in the executor's memory.
struct TreeView {
  static constexpr std::uint32_t inner = ~std::uint32_t{0};
  static constexpr int last_level = 63;  ///< includes deeper nodes
  std::int64_t nodes = 0;                ///< 0: the method has no tree, or there are no bodies
  const Aabb* box = nullptr;
  const std::uint32_t* parent = nullptr;       ///< the root is its own parent
  const std::uint32_t* first_child = nullptr;  ///< first child; `inner` for leaves
  const std::uint32_t* children = nullptr;     ///< number of children
  const std::uint32_t* body = nullptr;         ///< id; `inner` for inner nodes
  const std::uint32_t* leaf_body = nullptr;    ///< ids of the leaves in tree order
  /// First node of each level, and the number of nodes as last element.
  const std::vector<std::uint32_t>* first = nullptr;

  int levels() const { return first == nullptr ? 0 : static_cast<int>(first->size()) - 1; }
  std::uint32_t level_begin(int level) const { return (*first)[static_cast<std::size_t>(level)]; }
  std::uint32_t level_size(int level) const { return level_begin(level + 1) - level_begin(level); }
};

/// Statistics of a tree (BvhStatistics), in the executor's memory. Optional: null if not requested.
struct TreeValues {
  const float* of_node = nullptr;          ///< values of one metric, by node
  const std::uint32_t* of_body = nullptr;  ///< box tests of the body's query, by id
};

class Tree {
 public:
  explicit Tree(Executor& executor);
  /// Builds the level-ordered tree of a method that has been updated. Waits for the device.
  void build_level_order(const BroadPhase& method, std::int64_t bodies);
  const TreeView& view() const { return view_; }

 private:
  Executor& executor_;
  Buffer<Aabb> raw_box_, box_;
  Buffer<std::uint32_t> raw_parent_, leaf_body_, leftmost_;
  Buffer<std::uint64_t> deepest_;
  Buffer<std::uint64_t> key_, sorted_key_;
  Buffer<std::uint32_t> id_, order_, place_;
  Buffer<std::uint32_t> parent_, first_child_, children_, body_, level_first_;
  Buffer<std::byte> temporary_;
  std::vector<std::uint32_t> first_;
  TreeView view_;
};

}  // namespace collidoscope
