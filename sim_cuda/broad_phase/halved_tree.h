#pragma once
// A tree over n places that is halved level by level, as the k-d tree and the BSP are: node i of level L
// holds the places from floor(i n / 2^L) up to floor((i + 1) n / 2^L), whatever the bodies are, so its shape
// needs no memory. Each method brings the order of the places and, in each inner node, what parts its two
// halves. Inner nodes stand as in a heap: the root is 1, the children of h are 2h and 2h + 1.

#include <bit>
#include <cstdint>

#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/whole_record.h"

namespace collidoscope {

/// Of an inner node: places first .. middle - 1 are its left half, middle .. end - 1 the right one.
struct Halves {
  std::uint32_t first, middle, end;
  SIM_HD bool inner() const { return end - first > 1; }
};

struct Halving {
  static constexpr int max_levels = 27;  // 2^27 bodies

  std::uint32_t n = 0;
  int levels = 0;  ///< of inner nodes: the smallest with 2^levels >= n. On the last, some nodes are leaves

  Halving() = default;
  explicit Halving(std::int64_t places) : n(static_cast<std::uint32_t>(places)) {
    while (std::int64_t{1} << levels < places) ++levels;
  }
  std::size_t heap_size() const { return n > 1 ? std::size_t{1} << levels : 0; }

  SIM_HD std::uint32_t begin(int level, std::uint32_t node) const {
    return static_cast<std::uint32_t>(std::uint64_t{node} * n >> level);
  }
  SIM_HD Halves halves(int level, std::uint32_t node) const {
    return {begin(level, node), begin(level + 1, 2 * node + 1), begin(level, node + 1)};
  }
  /// The node of a level that holds a place.
  SIM_HD std::uint32_t node_at(int level, std::uint32_t place) const {
    return static_cast<std::uint32_t>((((std::uint64_t{place} + 1) << level) - 1) / n);
  }
  SIM_HD static std::uint32_t heap(int level, std::uint32_t node) { return (1u << level) + node; }

  /// In the numbers of TreeSink: each two neighbouring places are parted by one inner node.
  SIM_HD std::uint32_t number(const Halves& node) const {
    return node.inner() ? n + node.middle - 1 : node.first;
  }
};

/// What a node keeps of its halves: where the right one begins, and which of them is a leaf.
struct Cut {
  std::uint32_t bits;
  Cut() = default;
  SIM_HD explicit Cut(const Halves& h)
      : bits(h.middle | (h.middle - h.first == 1 ? 1u << 31 : 0u) | (h.end - h.middle == 1 ? 1u << 30 : 0u)) {
  }
  SIM_HD std::uint32_t middle() const { return bits & ((1u << 30) - 1); }
  SIM_HD bool left_is_leaf() const { return bits >> 31 & 1; }
  SIM_HD bool right_is_leaf() const { return bits >> 30 & 1; }
};

struct alignas(16) HalvedLeaf {
  float min[3];
  std::uint32_t body;
  float max[3];
  std::uint32_t unused;

  SIM_HD friend bool overlap(const HalvedLeaf& a, const HalvedLeaf& b) {
    return a.min[0] <= b.max[0] && b.min[0] <= a.max[0] && a.min[1] <= b.max[1] && b.min[1] <= a.max[1] &&
           a.min[2] <= b.max[2] && b.min[2] <= a.max[2];
  }
  SIM_HD Aabb box() const { return {Vector3f(min[0], min[1], min[2]), Vector3f(max[0], max[1], max[2])}; }
};
static_assert(sizeof(HalvedLeaf) == 32);

struct MakeHalvedLeaves {
  const Aabb* boxes;
  const std::uint32_t* order;
  HalvedLeaf* leaves;
  SIM_HD void operator()(int place) const {
    const Aabb box = boxes[order[place]];
    HalvedLeaf leaf;
    for (int k = 0; k < 3; ++k) {
      leaf.min[k] = box.min[k];
      leaf.max[k] = box.max[k];
    }
    leaf.body = order[place];
    leaf.unused = 0;
    store_whole(&leaves[place], leaf);
  }
};

/// Where a box counts when bodies are shared out: its centre; of an empty one, the origin.
SIM_HD inline float center_of(const Aabb& box, int axis) {
  return is_empty(box) ? 0.0f : 0.5f * box.min[axis] + 0.5f * box.max[axis];
}

/// Integers that order as the floats do, and back.
SIM_HD inline std::uint32_t ordered_bits(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return bits ^ (bits >> 31 ? ~0u : 1u << 31);
}
SIM_HD inline float from_ordered_bits(std::uint32_t bits) {
  return std::bit_cast<float>(bits ^ (bits >> 31 ? 1u << 31 : ~0u));
}

/// Which halves of a node a box may reach.
struct Reach {
  bool left, right;
};

/// One body's query, from the root with a stack. Only leaves to the right of its own are looked for, so that
/// each pair is found once. Node: `Cut cut`, `Reach reached_by(const HalvedLeaf&) const`.
template <class Node, class Sink>
struct DescendHalves {
  const Node* nodes;
  const HalvedLeaf* leaves;
  std::uint32_t n;
  Sink sink;

  SIM_HD void operator()(int item) const {
    const auto place = static_cast<std::uint32_t>(item);
    const HalvedLeaf query = load_whole(&leaves[place]);
    auto batch = start_query(sink, item, query.body);
    // A node pops before its children push: at most one entry a level waits, plus one.
    std::uint32_t stack[Halving::max_levels + 1];
    int waiting = 0;
    if (place + 1 < n) stack[waiting++] = 1;
    while (waiting > 0) {
      const std::uint32_t at = stack[--waiting];
      const Node node = load_whole(&nodes[at]);
      batch.visit();
      const Reach reach = node.reached_by(query);
      const std::uint32_t middle = node.cut.middle();
      if (reach.left && middle > place + 1) {
        if (node.cut.left_is_leaf())
          meet(query, middle - 1, batch);
        else
          stack[waiting++] = 2 * at;
      }
      if (reach.right) {  // its last place is the node's, which is to the right
        if (node.cut.right_is_leaf())
          meet(query, middle, batch);
        else
          stack[waiting++] = 2 * at + 1;
      }
    }
    batch.finish();
  }
  template <class Batch>
  SIM_HD void meet(const HalvedLeaf& query, std::uint32_t place, Batch& batch) const {
    const HalvedLeaf other = load_whole(&leaves[place]);
    batch.visit();
    if (overlap(query, other)) batch.add(other.body);
  }
};

}  // namespace collidoscope
