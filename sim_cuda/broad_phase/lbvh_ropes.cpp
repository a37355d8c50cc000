// A linear BVH, built bottom-up in one launch. Leaves in Morton order climb the tree; at each node, the
// second child to arrive continues (Apetrei 2014). Nodes are numbered as by Karras 2012, so that each node
// can compute its right neighbour, which is its rope (Prokopenko & Lebrun-Grandié 2024). Queries traverse the
// tree along ropes.
//
// On a GPU, the leaves of a warp are merged first, without memory traffic. Merging boxes involves no
// rounding, so the tree is the same.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/key_difference.h"
#include "sim_cuda/broad_phase/morton_order.h"
#include "sim_cuda/broad_phase/rope_walk.h"
#include "sim_cuda/core/vector_load.h"

namespace collidoscope {

namespace {

/// The subtree of leaves first .. last, during the climb.
struct Subtree {
  std::uint32_t first, last;
  std::uint32_t left, right;  ///< split bits at the left and right end
  RopedNode node;

  /// Whether it is a left child. The sibling of a left child is to the right.
  SIM_HD bool is_left() const { return right < left; }
  SIM_HD bool is_root() const { return left == right; }
};

/// Data that the first child to arrive at a split stores for the second.
struct FirstArrival {
  static constexpr std::uint64_t none = ~std::uint64_t{0};
  std::uint32_t far_end, split_bit;  ///< the end away from the split, and the split bit there

  SIM_HD std::uint64_t packed() const { return std::uint64_t{split_bit} << 32 | far_end; }
  SIM_HD static FirstArrival unpacked(std::uint64_t packed) {
    return {static_cast<std::uint32_t>(packed), static_cast<std::uint32_t>(packed >> 32)};
  }
};

/// Climbs from n leaves to the root. Inner nodes have the numbers n + k: k is the last leaf of a left child,
/// the first leaf of a right child, and 0 for the root.
struct Climb {
  std::uint32_t n;
  RopedNode* nodes;
  std::uint64_t* arrivals;  ///< by split

  /// Merges a subtree with its sibling and stores the parent.
  SIM_HD void join(Subtree& own, const FirstArrival& arrival, const RopedNode& sibling) const {
    const bool is_left = own.is_left();
    const std::uint32_t split = is_left ? own.last : own.first - 1;
    if (is_left) {
      own.last = arrival.far_end;
      own.right = arrival.split_bit;
      own.node.rope = sibling.rope;
    } else {
      own.first = arrival.far_end;
      own.left = arrival.split_bit;
    }
    for (int k = 0; k < 3; ++k) {
      own.node.min[k] = min_of(own.node.min[k], sibling.min[k]);
      own.node.max[k] = max_of(own.node.max[k], sibling.max[k]);
    }
    own.node.child = split == own.first ? split : n + split;
    store_vectorized(&nodes[n + (own.is_root() ? 0 : own.is_left() ? own.last : own.first)], own.node);
  }

  /// Merges a subtree with the neighbour at the lower split bit, up to the root. The first child to arrive
  /// stores its range and stops; the second continues.
  SIM_HD void climb(Subtree own) const {
    while (!own.is_root()) {
      const bool is_left = own.is_left();
      const std::uint32_t split = is_left ? own.last : own.first - 1;
      const FirstArrival range =
          is_left ? FirstArrival{own.first, own.left} : FirstArrival{own.last, own.right};
      const std::uint64_t previous = atomic_exchange(&arrivals[split], range.packed());
      if (previous == FirstArrival::none) return;
      arrivals[split] = FirstArrival::none;  // both children have arrived
      const FirstArrival other = FirstArrival::unpacked(previous);
      const std::uint32_t place = is_left ? split + 1 : split;
      join(own, other, load_l2(&nodes[other.far_end == place ? place : n + place]));
    }
  }
};

template <class Key>
struct Build {
  const Key* keys;
  const std::uint32_t* body_at;
  const Aabb* boxes;
  Climb above;

  SIM_HD std::uint32_t split_bit_at(std::uint32_t i) const { return split_bit(keys, above.n, i); }
  /// Rope of a node whose last leaf is `place`, with the split bit `right`. The node after the split is a
  /// left child, or a leaf if the next split bit is higher.
  SIM_HD std::uint32_t rope(std::uint32_t place, std::uint32_t right) const {
    if (place == above.n - 1) return no_rope;
    return split_bit_at(place + 1) < right ? above.n + place + 1 : place + 1;
  }
  SIM_HD Subtree leaf(std::uint32_t place) const {
    Subtree leaf{place, place, split_bit_at(place - 1), split_bit_at(place), {}};
    leaf.node.child = body_at[place];
    leaf.node.set_box(boxes[leaf.node.child]);
    leaf.node.rope = rope(place, leaf.right);
    store_vectorized(&above.nodes[place], leaf.node);
    return leaf;
  }
  SIM_HD void operator()(int item) const { above.climb(leaf(static_cast<std::uint32_t>(item))); }
};

#if defined(__CUDACC__)

/// Merges the leaves of a warp first, in lockstep. A subtree is held by the lane of its first leaf, so the
/// sibling of a left child is held by the next active lane. The remaining subtrees, whose siblings are
/// outside the warp, continue in global memory.
template <class Key>
__global__ void __launch_bounds__(1024) build_by_warp(const Build<Key> build) {
  constexpr std::uint32_t warp_size = 32;
  const std::uint32_t n = build.above.n, lane = threadIdx.x % warp_size;
  const std::uint32_t lanes = min(warp_size, blockDim.x - (threadIdx.x - lane));
  const std::uint32_t all = lanes == warp_size ? ~0u : (1u << lanes) - 1;
  const std::uint64_t stride = std::uint64_t{gridDim.x} * blockDim.x;
  std::uint64_t begin = std::uint64_t{blockIdx.x} * blockDim.x + (threadIdx.x - lane);
  for (; begin < n; begin += stride) {
    bool active = begin + lane < n;
    Subtree own = build.leaf(active ? static_cast<std::uint32_t>(begin) + lane : n - 1);
    for (;;) {
      const bool is_left = own.is_left();
      const std::uint32_t active_lanes = __ballot_sync(all, active), lefts = __ballot_sync(all, is_left);
      const std::uint32_t before = active_lanes & ((1u << lane) - 1),
                          after = active_lanes & ~((2u << lane) - 1);
      const int previous = 31 - __clz(static_cast<int>(before)), next = __ffs(static_cast<int>(after)) - 1;
      const bool joins = active && is_left && after != 0 && !(lefts >> next & 1);
      if (__ballot_sync(all, joins) == 0) break;
      if (!is_left && before != 0 && (lefts >> previous & 1)) active = false;
      const int from = joins ? next : static_cast<int>(lane);
      RopedNode sibling;
      for (int k = 0; k < 3; ++k) {
        sibling.min[k] = __shfl_sync(all, own.node.min[k], from);
        sibling.max[k] = __shfl_sync(all, own.node.max[k], from);
      }
      sibling.rope = __shfl_sync(all, own.node.rope, from);
      const FirstArrival arrival{__shfl_sync(all, own.last, from), __shfl_sync(all, own.right, from)};
      if (joins) build.above.join(own, arrival, sibling);
    }
    __syncwarp(all);  // makes the stores of this warp visible to the threads that merge their parents
    if (active) build.above.climb(own);
  }
}

#endif

/// Writes the parents: each inner node writes the parent of its two children. The right child is the rope of
/// the left one.
struct WriteRopedTree {
  const RopedNode* nodes;
  std::uint32_t n;
  TreeSink sink;
  SIM_HD void operator()(int item) const {
    const auto node = static_cast<std::uint32_t>(item);
    const RopedNode from = nodes[node];
    sink.box[node] = from.box();
    if (node < n) {
      sink.leaf_body[node] = from.child;
    } else {
      sink.parent[from.child] = node;
      sink.parent[nodes[from.child].rope] = node;
    }
    if (node == (n > 1 ? n : 0)) sink.parent[node] = node;
  }
};

template <class Key>
class LbvhRopes final : public RopeTreeMethod<Key> {
  using Base = RopeTreeMethod<Key>;
  using Base::executor_, Base::n_, Base::nodes_, Base::order_;

 public:
  explicit LbvhRopes(Executor& executor)
      : Base(executor, LeafOrder::left_to_right), arrivals_(executor, "arrival records") {}

  void reserve(std::int64_t bodies) override {
    Base::reserve(bodies);
    arrivals_.resize_discarding(n_);
    executor_.fill(arrivals_.data(), 0xff, arrivals_.bytes());  // no arrivals
  }
  void update(const Aabb* boxes, const Aabb* extent) override {
    if (n_ == 0) return;
    order_.sort(boxes, extent);
    const Build<Key> build{order_.keys(), order_.bodies(), boxes, {n_, nodes_.data(), arrivals_.data()}};
#if defined(__CUDACC__)
    if (executor_.on_device())
      return executor_.run_kernel("build", {n_, false, nullptr}, build_by_warp<Key>, build);
#endif
    executor_.run("build", n_, build);
  }
  void write_tree(const TreeSink& sink) const override {
    executor_.run("tree", Base::tree_nodes(), WriteRopedTree{nodes_.data(), n_, sink});
  }

 private:
  Buffer<std::uint64_t> arrivals_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_lbvh_ropes(Executor& executor) {
  if (executor.options().key_bits == 63) return std::make_unique<LbvhRopes<std::uint64_t>>(executor);
  return std::make_unique<LbvhRopes<std::uint32_t>>(executor);
}

}  // namespace collidoscope
