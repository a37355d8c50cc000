// A linear BVH in one bottom-up launch: the leaves, in Morton order, climb; where two meet, the second goes
// on (Apetrei 2014) with the node numbers of Karras 2012, which tell each node where its right neighbour
// stands: its rope (Prokopenko & Lebrun-Grandié 2024). A query starts at its own leaf's rope and walks right,
// down into what it overlaps and along the ropes past what it does not, so that it needs no stack and finds
// each pair once (half traversal).

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/morton_order.h"
#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/broad_phase/parting.h"
#include "sim_cuda/core/whole_record.h"

namespace collidoscope {

namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};

/// 32 bytes: a GPU reads it in two loads from one sector. Inner nodes are 0 .. n-2, the root is 0; leaf k is
/// n - 1 + k.
struct alignas(16) RopeNode {
  float min[3];
  std::uint32_t child;  ///< the left one; of a leaf: the id of its body
  float max[3];
  std::uint32_t rope;  ///< the node to the right of this subtree; none: it was the last
};
static_assert(sizeof(RopeNode) == 32);

SIM_HD inline bool overlap(const RopeNode& a, const RopeNode& b) {
  return a.min[0] <= b.max[0] && b.min[0] <= a.max[0] && a.min[1] <= b.max[1] && b.min[1] <= a.max[1] &&
         a.min[2] <= b.max[2] && b.min[2] <= a.max[2];
}

struct MakeLeaf {
  const Aabb* boxes;
  RopeNode* leaves;
  std::uint32_t* met;
  SIM_HD void operator()(std::uint32_t place, std::uint32_t body) const {
    const Aabb box = boxes[body];
    RopeNode leaf;
    for (int k = 0; k < 3; ++k) {
      leaf.min[k] = box.min[k];
      leaf.max[k] = box.max[k];
    }
    leaf.child = body;
    leaf.rope = none;
    store_whole(&leaves[place], leaf);
    met[place] = none;
  }
};

template <class Key>
struct Climb {
  using Parting = decltype(parting_of(Key{}, 0u));
  const Key* keys;
  std::uint32_t n;
  RopeNode* nodes;
  std::uint32_t* met;  ///< at each parting, the far end of the subtree that came first

  /// Between leaves i and i + 1; beyond both ends, the highest.
  SIM_HD Parting parting(std::uint32_t i) const {
    if (i >= n - 1) return parting_of(~Key{0}, none);  // i = -1 too
    return parting_of(keys[i] ^ keys[i + 1], i ^ (i + 1));
  }
  /// Of a subtree whose last leaf is `last`: the right child of the node that parts there. It starts with
  /// leaf last + 1, and is this leaf alone if that parts from the next one higher up.
  SIM_HD std::uint32_t rope(std::uint32_t last, const Parting& right) const {
    if (last == n - 1) return none;
    const bool leaf = !(parting(last + 1) < right);
    return leaf ? n - 1 + last + 1 : last + 1;
  }

  SIM_HD void operator()(int item) const {
    std::uint32_t first = static_cast<std::uint32_t>(item), last = first;
    RopeNode node = load_fresh(&nodes[n - 1 + first]);
    Parting left = parting(first - 1), right = parting(last);
    nodes[n - 1 + first].rope = rope(last, right);
    while (first > 0 || last < n - 1) {
      // A subtree joins the neighbour from which it parts lower in the tree. Who comes first leaves the other
      // end of the subtree and stops.
      const bool is_left = right < left;
      const std::uint32_t split = is_left ? last : first - 1;
      const std::uint32_t far = atomic_swap(&met[split], is_left ? first : last);
      if (far == none) return;
      std::uint32_t sibling;
      if (is_left) {
        sibling = far == split + 1 ? n - 1 + far : split + 1;
        last = far;
      } else {
        sibling = far == split ? n - 1 + far : split;
        first = far;
      }
      const RopeNode other = load_fresh(&nodes[sibling]);
      for (int k = 0; k < 3; ++k) {
        node.min[k] = min_of(node.min[k], other.min[k]);
        node.max[k] = max_of(node.max[k], other.max[k]);
      }
      left = parting(first - 1);
      right = parting(last);
      node.child = split == first ? n - 1 + split : split;
      node.rope = rope(last, right);
      // Karras: a left child has the number of its last leaf, a right one that of its first, the root 0.
      store_whole(&nodes[first > 0 || last < n - 1 ? (right < left ? last : first) : 0], node);
    }
  }
};

struct WalkRight {
  const RopeNode* nodes;
  std::uint32_t n;
  PairSink sink;
  SIM_HD void operator()(int leaf) const {
    const RopeNode query = load_whole(&nodes[n - 1 + static_cast<std::uint32_t>(leaf)]);
    PairBatch batch(sink, query.child);
    for (std::uint32_t at = query.rope; at != none;) {
      const RopeNode node = load_whole(&nodes[at]);
      const bool hit = overlap(query, node), is_leaf = at >= n - 1;
      if (hit && is_leaf) batch.add(node.child);
      at = hit && !is_leaf ? node.child : node.rope;
    }
    batch.finish();
  }
};

/// A right child is where the rope of the left one leads; parents tell their children.
struct WriteTree {
  const RopeNode* nodes;
  std::uint32_t n;
  TreeSink sink;
  SIM_HD std::uint32_t number(std::uint32_t node) const { return node < n - 1 ? n + node : node - (n - 1); }
  SIM_HD void operator()(int item) const {
    const auto node = static_cast<std::uint32_t>(item);
    const RopeNode from = nodes[node];
    Aabb box;
    for (int k = 0; k < 3; ++k) {
      box.min[k] = from.min[k];
      box.max[k] = from.max[k];
    }
    const std::uint32_t to = number(node);
    sink.box[to] = box;
    if (node == 0) sink.parent[to] = to;
    if (node >= n - 1) {
      sink.leaf_body[to] = from.child;
    } else {
      sink.parent[number(from.child)] = to;
      sink.parent[number(nodes[from.child].rope)] = to;
    }
  }
};

template <class Key>
class LbvhRopes final : public BroadPhase {
 public:
  explicit LbvhRopes(Executor& executor)
      : executor_(executor),
        order_(executor),
        nodes_(executor, "tree nodes"),
        met_(executor, "tree climbers") {}

  void reserve(std::int64_t bodies) override {
    n_ = static_cast<std::uint32_t>(bodies);
    order_.reserve(bodies);
    nodes_.resize_discarding(n_ > 0 ? 2 * static_cast<std::size_t>(n_) - 1 : 0);
    met_.resize_discarding(n_);
  }
  void update(const Aabb* boxes, const Aabb* extent) override {
    if (n_ == 0) return;
    order_.sort(boxes, extent, MakeLeaf{boxes, nodes_.data() + n_ - 1, met_.data()});
    executor_.run("build", n_, Climb<Key>{order_.keys(), n_, nodes_.data(), met_.data()});
  }
  void find_pairs(const PairSink& sink) override {
    executor_.run("pairs", n_, WalkRight{nodes_.data(), n_, sink});
  }
  std::int64_t tree_nodes() const override { return static_cast<std::int64_t>(nodes_.size()); }
  void write_tree(const TreeSink& sink) const override {
    executor_.run("tree", tree_nodes(), WriteTree{nodes_.data(), n_, sink});
  }

 private:
  Executor& executor_;
  std::uint32_t n_ = 0;
  MortonOrder<Key> order_;
  Buffer<RopeNode> nodes_;
  Buffer<std::uint32_t> met_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_lbvh_ropes(Executor& executor) {
  if (executor.options().key_bits == 63) return std::make_unique<LbvhRopes<std::uint64_t>>(executor);
  return std::make_unique<LbvhRopes<std::uint32_t>>(executor);
}

}  // namespace collidoscope
