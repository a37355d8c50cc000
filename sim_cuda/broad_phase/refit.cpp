// A linear BVH that is reused across steps. Bodies that move little stay neighbours, so most steps keep the
// topology (Karras's, from the Morton order of the last build) and update the boxes bottom-up. The pairs are
// correct for any motion, because all boxes are recomputed. Large motion only enlarges boxes and slows down
// queries.
//
// Rebuild criterion: the sum of inner surface areas, which determines the query cost, exceeds 1.25 times its
// minimum since the last build. The next update then sorts and links anew. The decision is a counter in the
// executor's memory: the item count of the build stages, all or none. A recorded step therefore needs no
// readback, and the step after a large motion is slow.
//
// (The library sort, as for 63-bit keys, runs in every step, with the old keys if there is no rebuild.)

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/key_difference.h"
#include "sim_cuda/broad_phase/morton_order.h"
#include "sim_cuda/broad_phase/rope_tree.h"
#include "sim_cuda/core/reduce.h"
#include "sim_cuda/core/vector_load.h"

namespace collidoscope {

namespace {

constexpr double rebuild_ratio = 1.25;  // of the minimum sum of areas

/// Item counts of the next update's build stages, and the reference area.
struct RebuildState {
  std::uint32_t leaves, nodes;  ///< all, or 0
  double least_area;            ///< m^2, minimum since the last build
};

struct AreaSum {
  double area = 0;
};
SIM_HD inline AreaSum combine(const AreaSum& a, const AreaSum& b) { return {a.area + b.area}; }

struct PlaceLeafBody {
  RopedNode* leaves;
  SIM_HD void operator()(std::uint32_t place, std::uint32_t body) const { leaves[place].child = body; }
};

/// Links the tree: leaves climb, and the second child to arrive at a split links both children and continues
/// (Apetrei 2014). The node that splits leaves i and i + 1 has the number n + i.
template <class Key>
struct LinkNodes {
  const Key* keys;
  std::uint32_t n;
  RopedNode* nodes;
  TreeLinks links;
  std::uint32_t* arrival;  ///< by split: `no_rope`, or the far end of the first subtree to arrive

  SIM_HD std::uint32_t split_bit_at(std::uint32_t i) const { return split_bit(keys, n, i); }
  SIM_HD void operator()(int item) const {
    std::uint32_t first = static_cast<std::uint32_t>(item), last = first, at = first;
    while (first > 0 || last < n - 1) {
      const bool is_left = split_bit_at(last) < split_bit_at(first - 1);
      const std::uint32_t split = is_left ? last : first - 1;
      RopedNode& above = nodes[n + split];
      // Until the escape indices are set, the rope is the right child.
      (is_left ? above.child : above.rope) = at;
      const std::uint32_t far = atomic_exchange(&arrival[split], is_left ? first : last);
      if (far == no_rope) return;
      arrival[split] = no_rope;  // both children have arrived
      const std::uint32_t other = atomic_load(is_left ? &above.rope : &above.child);
      links.join(is_left ? at : other, is_left ? other : at, n + split);
      (is_left ? last : first) = far;
      at = n + split;
    }
    links.link[at] = no_rope;
  }
};

/// Updates all boxes: leaves copy the boxes of their bodies and climb; the second child to arrive continues.
struct RefitNodes {
  const Aabb* boxes;
  std::uint32_t n;
  RopedNode* nodes;
  TreeLinks links;
  std::uint32_t* arrival;
  SIM_HD void operator()(int item) const {
    auto at = static_cast<std::uint32_t>(item);
    RopedNode node = nodes[at];
    Aabb box = boxes[node.child];
    for (;;) {
      node.set_box(box);
      store_vectorized(&nodes[at], node);
      if (links.is_root(at)) return;
      const std::uint32_t above = links.parent(at);
      if (atomic_exchange(&arrival[above - n], at) == no_rope) return;
      arrival[above - n] = no_rope;
      node.child = nodes[above].child;
      node.rope = nodes[above].rope;
      const std::uint32_t sibling = links.is_left(at) ? links.link[at] : node.child;
      box = combine(box, load_l2(&nodes[sibling]).box());
      at = above;
    }
  }
};

struct InnerArea {
  const RopedNode* nodes;
  SIM_HD AreaSum operator()(std::int64_t item) const {
    const RopedNode node = load_readonly(&nodes[item]);
    double side[3];
    for (int k = 0; k < 3; ++k)
      side[k] = max_of(static_cast<double>(node.max[k]) - static_cast<double>(node.min[k]), 0.0);
    return {2 * (side[0] * side[1] + side[1] * side[2] + side[2] * side[0])};
  }
};

struct DecideRebuild {
  const AreaSum* now;
  std::uint32_t n;
  RebuildState* rebuild_state;
  SIM_HD void operator()(int) const {
    const bool built = rebuild_state->leaves != 0;
    if (built || now->area < rebuild_state->least_area) rebuild_state->least_area = now->area;
    const bool rebuild = now->area > rebuild_ratio * rebuild_state->least_area;
    rebuild_state->leaves = rebuild ? n : 0;
    rebuild_state->nodes = rebuild ? 2 * n - 1 : 0;
  }
};

template <class Key>
class RefitBvh final : public RopeTreeMethod<Key> {
  using Base = RopeTreeMethod<Key>;
  using Base::executor_, Base::n_, Base::nodes_, Base::order_;

 public:
  explicit RefitBvh(Executor& executor)
      : Base(executor, LeafOrder::left_to_right),
        link_(executor, "node links"),
        arrival_(executor, "arrival counters"),
        sums_(executor, "area sums"),
        rebuild_state_(executor, "rebuild state") {}

  void reserve(std::int64_t bodies) override {
    Base::reserve(bodies);
    link_.resize_discarding(nodes_.size());
    arrival_.resize_discarding(n_);
    executor_.fill(arrival_.data(), 0xff, arrival_.bytes());
    sums_.resize_discarding(reduce_scratch_size(bodies));
    rebuild_state_.upload({RebuildState{n_, static_cast<std::uint32_t>(nodes_.size()), 0}});
  }

  void update(const Aabb* boxes, const Aabb* extent) override {
    if (n_ == 0) return;
    RebuildState* rebuild_state = rebuild_state_.data();
    const ItemCount leaves(&rebuild_state->leaves, n_), nodes(&rebuild_state->nodes, Base::tree_nodes());
    const TreeLinks links{link_.data()};
    order_.sort(boxes, extent, PlaceLeafBody{nodes_.data()}, leaves);
    executor_.run("build", leaves, LinkNodes<Key>{order_.keys(), n_, nodes_.data(), links, arrival_.data()});
    executor_.run("build", nodes, SetEscapeIndices{links, nodes_.data()});
    executor_.run("build", n_, RefitNodes{boxes, n_, nodes_.data(), links, arrival_.data()});
    if (n_ == 1) return;
    const AreaSum* area =
        reduce<AreaSum>(executor_, "build", n_ - 1, InnerArea{nodes_.data() + n_}, sums_.data());
    executor_.run("build", 1, DecideRebuild{area, n_, rebuild_state});
  }

  void write_tree(const TreeSink& sink) const override {
    if (n_ > 0) write_rope_tree(executor_, n_, nodes_.data(), {link_.data()}, sink);
  }

 private:
  Buffer<std::uint32_t> link_, arrival_;
  Buffer<AreaSum> sums_;
  Buffer<RebuildState> rebuild_state_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_refit(Executor& executor) {
  if (executor.options().key_bits == 63) return std::make_unique<RefitBvh<std::uint64_t>>(executor);
  return std::make_unique<RefitBvh<std::uint32_t>>(executor);
}

}  // namespace collidoscope
