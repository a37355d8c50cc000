// A linear BVH that outlives the step: bodies that move little stay neighbours, so most steps keep its
// topology (Karras's, from the Morton order at the last build) and give each node its new box, from the
// leaves up. Any motion is right, for every box is made anew; a bad one only makes boxes large and queries
// slow.
//
// Rebuilt on decay: the sum of the areas of the inner boxes, which is what queries pay for, is compared with
// the least since the last build. Once it is a quarter more, the next update sorts and links anew. The
// decision is a counter in the executor's memory, which says of how many items the stages of building
// consist: all or none; so a recorded step needs no answer from the device, and after a leap one step is
// slow. (Where the library sorts, as with 63-bit keys, it sorts in every step, the old keys if no new ones.)

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/morton_order.h"
#include "sim_cuda/broad_phase/parting.h"
#include "sim_cuda/broad_phase/rope_tree.h"
#include "sim_cuda/core/reduce.h"
#include "sim_cuda/core/whole_record.h"

namespace collidoscope {

namespace {

constexpr double decayed = 1.25;  // of the least sum of areas

/// What the next update builds, and by what it is judged.
struct Upkeep {
  std::uint32_t leaves, nodes;  ///< all, or 0
  double least_area;            ///< m^2, since the last build
};

struct AreaSum {
  double area = 0;
};
SIM_HD inline AreaSum combine(const AreaSum& a, const AreaSum& b) { return {a.area + b.area}; }

struct PlaceLeafBody {
  RopedNode* leaves;
  SIM_HD void operator()(std::uint32_t place, std::uint32_t body) const { leaves[place].child = body; }
};

/// Leaves climb; where two subtrees meet, the second to come links them and goes on (Apetrei 2014). The node
/// that parts leaves i and i + 1 is n + i.
template <class Key>
struct LinkNodes {
  const Key* keys;
  std::uint32_t n;
  RopedNode* nodes;
  TreeLinks links;
  std::uint32_t* met;  ///< by parting: `no_rope`, or the far end of the subtree that came first

  SIM_HD std::uint32_t height(std::uint32_t i) const { return parting_height(keys, n, i); }
  SIM_HD void operator()(int item) const {
    std::uint32_t first = static_cast<std::uint32_t>(item), last = first, at = first;
    while (first > 0 || last < n - 1) {
      const bool is_left = height(last) < height(first - 1);
      const std::uint32_t split = is_left ? last : first - 1;
      RopedNode& above = nodes[n + split];
      (is_left ? above.child : above.rope) = at;  // until the ropes are tied, the right child
      const std::uint32_t far = atomic_swap(&met[split], is_left ? first : last);
      if (far == no_rope) return;
      met[split] = no_rope;  // both were here
      const std::uint32_t other = atomic_load(is_left ? &above.rope : &above.child);
      links.join(is_left ? at : other, is_left ? other : at, n + split);
      (is_left ? last : first) = far;
      at = n + split;
    }
    links.link[at] = no_rope;
  }
};

/// Leaves take the boxes of their bodies and climb; where two subtrees meet, the second to come goes on.
struct RefitNodes {
  const Aabb* boxes;
  std::uint32_t n;
  RopedNode* nodes;
  TreeLinks links;
  std::uint32_t* met;
  SIM_HD void operator()(int item) const {
    auto at = static_cast<std::uint32_t>(item);
    RopedNode node = nodes[at];
    Aabb box = boxes[node.child];
    for (;;) {
      node.set_box(box);
      store_whole(&nodes[at], node);
      if (links.is_root(at)) return;
      const std::uint32_t above = links.parent(at);
      if (atomic_swap(&met[above - n], at) == no_rope) return;
      met[above - n] = no_rope;
      node.child = nodes[above].child;
      node.rope = nodes[above].rope;
      const std::uint32_t sibling = links.is_left(at) ? links.link[at] : node.child;
      box = combine(box, load_fresh(&nodes[sibling]).box());
      at = above;
    }
  }
};

struct InnerArea {
  const RopedNode* nodes;
  SIM_HD AreaSum operator()(std::int64_t item) const {
    const RopedNode node = load_whole(&nodes[item]);
    double side[3];
    for (int k = 0; k < 3; ++k)
      side[k] = max_of(static_cast<double>(node.max[k]) - static_cast<double>(node.min[k]), 0.0);
    return {2 * (side[0] * side[1] + side[1] * side[2] + side[2] * side[0])};
  }
};

struct Judge {
  const AreaSum* now;
  std::uint32_t n;
  Upkeep* upkeep;
  SIM_HD void operator()(int) const {
    const bool built = upkeep->leaves != 0;
    if (built || now->area < upkeep->least_area) upkeep->least_area = now->area;
    const bool rebuild = now->area > decayed * upkeep->least_area;
    upkeep->leaves = rebuild ? n : 0;
    upkeep->nodes = rebuild ? 2 * n - 1 : 0;
  }
};

template <class Key>
class RefitBvh final : public RopeTreeMethod<Key> {
  using Base = RopeTreeMethod<Key>;
  using Base::executor_, Base::n_, Base::nodes_, Base::order_;

 public:
  explicit RefitBvh(Executor& executor)
      : Base(executor),
        link_(executor, "links of nodes"),
        met_(executor, "tree climbers"),
        sums_(executor, "sums of areas"),
        upkeep_(executor, "upkeep of the tree") {}

  void reserve(std::int64_t bodies) override {
    Base::reserve(bodies);
    link_.resize_discarding(nodes_.size());
    met_.resize_discarding(n_);
    executor_.fill(met_.data(), 0xff, met_.bytes());
    sums_.resize_discarding(reduce_scratch_size(bodies));
    upkeep_.upload({Upkeep{n_, static_cast<std::uint32_t>(nodes_.size()), 0}});
  }

  void update(const Aabb* boxes, const Aabb* extent) override {
    if (n_ == 0) return;
    Upkeep* upkeep = upkeep_.data();
    const ItemCount leaves(&upkeep->leaves, n_), nodes(&upkeep->nodes, Base::tree_nodes());
    const TreeLinks links{link_.data()};
    order_.sort(boxes, extent, PlaceLeafBody{nodes_.data()}, leaves);
    executor_.run("build", leaves, LinkNodes<Key>{order_.keys(), n_, nodes_.data(), links, met_.data()});
    executor_.run("build", nodes, TieRopes{links, nodes_.data()});
    executor_.run("build", n_, RefitNodes{boxes, n_, nodes_.data(), links, met_.data()});
    if (n_ == 1) return;
    const AreaSum* area =
        reduce<AreaSum>(executor_, "build", n_ - 1, InnerArea{nodes_.data() + n_}, sums_.data());
    executor_.run("build", 1, Judge{area, n_, upkeep});
  }

  void write_tree(const TreeSink& sink) const override {
    if (n_ > 0) write_rope_tree(executor_, n_, nodes_.data(), {link_.data()}, sink);
  }

 private:
  Buffer<std::uint32_t> link_, met_;
  Buffer<AreaSum> sums_;
  Buffer<Upkeep> upkeep_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_refit(Executor& executor) {
  if (executor.options().key_bits == 63) return std::make_unique<RefitBvh<std::uint64_t>>(executor);
  return std::make_unique<RefitBvh<std::uint32_t>>(executor);
}

}  // namespace collidoscope
