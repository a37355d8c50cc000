#pragma once
// Any method's hierarchy in one form, for those who draw it, measure it or look a body up in it. Made outside
// the step, on request: inside it each method keeps the layout that is best for its own queries.
//
// Nodes stand level by level, the root first, and within a level from left to right, so that a level is a
// range of nodes and the children of a node follow each other one level below. Every body is a leaf, at
// whatever depth its method put it. The 64th level is of all nodes as deep or deeper, in the same order: few
// trees are so deep, and those are lists.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/buffer.h"

namespace collidoscope {

class BroadPhase;

/// Where a method writes its tree of n bodies, in the executor's memory: leaves have the numbers 0 .. n-1 in
/// the tree's order from left to right, inner nodes follow in any order.
struct TreeSink {
  Aabb* box;
  std::uint32_t* parent;     ///< of the root: itself
  std::uint32_t* leaf_body;  ///< of the leaves alone: the id of the body
};

/// An arranged tree in the executor's memory.
struct TreeView {
  static constexpr std::uint32_t inner = ~std::uint32_t{0};
  static constexpr int last_level = 63;  ///< and deeper
  std::int64_t nodes = 0;                ///< 0: the method has none, or there are no bodies
  const Aabb* box = nullptr;
  const std::uint32_t* parent = nullptr;       ///< of the root: itself
  const std::uint32_t* first_child = nullptr;  ///< where the children begin; of a leaf: none, `inner`
  const std::uint32_t* children = nullptr;     ///< how many
  const std::uint32_t* body = nullptr;         ///< id; `inner` for inner nodes
  const std::uint32_t* leaf_body = nullptr;    ///< ids in the tree's order
  const std::vector<std::uint32_t>* first =
      nullptr;  ///< node at which each level starts, and one past the last

  int levels() const { return first == nullptr ? 0 : static_cast<int>(first->size()) - 1; }
  std::uint32_t level_begin(int level) const { return (*first)[static_cast<std::size_t>(level)]; }
  std::uint32_t level_size(int level) const { return level_begin(level + 1) - level_begin(level); }
};

/// What was measured of it (BvhStatistics), in the executor's memory; null where nobody asks for it.
struct TreeValues {
  const float* of_node = nullptr;          ///< of one metric, by place
  const std::uint32_t* of_body = nullptr;  ///< boxes that its query tests, by id
};

class Tree {
 public:
  explicit Tree(Executor& executor);
  /// The tree of a method that has its boxes. Waits for the device.
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
