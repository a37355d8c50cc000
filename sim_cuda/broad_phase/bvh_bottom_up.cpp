// The paper's hierarchy. Its leaves are the bodies in Morton order. Each level merges every two consecutive
// nodes of the level below (its Figure 7), until one is left. The tree is implicit: node i has the children
// 2i and 2i+1 of the level below. The build therefore needs no queue and no atomics: one launch per level. A
// query descends from the root with a stack in local memory (its 3.2.4).
//
// Two variants. bvh_input_order has leaves ordered by id (its Figure 6, left), which shows the effect of
// clustering. bvh_recursive has recursive queries instead of a stack, which the paper expects to be five
// times slower (its 3.2.4).

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/morton_order.h"
#include "sim_cuda/broad_phase/pair_sink.h"

namespace collidoscope {

namespace {

/// Boxes by level. Level 0 has the leaves, one per body, in tree order.
struct LevelTree {
  static constexpr int max_levels = 28;  // 2^27 bodies
  Aabb* nodes = nullptr;
  std::uint32_t* leaf_body = nullptr;
  int levels = 0;
  std::uint32_t first[max_levels] = {};  // first node of each level
  std::uint32_t size[max_levels] = {};   // nodes per level; 1 in the last level, the root
};

struct MakeLeaf {
  const Aabb* boxes;
  Aabb* leaves;
  std::uint32_t* leaf_body;
  SIM_HD void operator()(std::uint32_t place, std::uint32_t body) const {
    leaves[place] = boxes[body];
    leaf_body[place] = body;
  }
};

struct MergeLevel {
  const Aabb* children;
  std::uint32_t child_count;
  Aabb* parents;
  SIM_HD void operator()(int parent) const {
    const auto left = 2u * static_cast<std::uint32_t>(parent);
    parents[parent] = left + 1 < child_count ? combine(children[left], children[left + 1]) : children[left];
  }
};

/// One body's query. Half traversal reports only leaves to the right of the body's own, so each pair is found
/// once. With `whole`, the query visits all overlapping nodes, and skips leaves to the left.
template <class Sink>
struct Descend {
  LevelTree tree;
  bool whole;
  Sink sink;
  SIM_HD void operator()(int leaf) const {
    const auto slot = static_cast<std::uint32_t>(leaf), from = whole ? 0 : slot + 1;
    const Aabb box = tree.nodes[slot];
    auto batch = start_query(sink, leaf, tree.leaf_body[slot]);
    // A stack entry is (level, node in level) of an overlapping node. A node is popped before its two
    // children are pushed. So the stack holds at most one entry per level, plus one.
    constexpr int level_shift = 27;
    constexpr std::uint32_t node_mask = (1u << level_shift) - 1;
    std::uint32_t stack[LevelTree::max_levels + 1];
    int depth = 0;
    if (tree.levels > 1) stack[depth++] = static_cast<std::uint32_t>(tree.levels - 1) << level_shift;
    while (depth > 0) {
      const std::uint32_t entry = stack[--depth];
      const std::uint32_t level = (entry >> level_shift) - 1;  // level of the children
      const std::uint32_t left = 2 * (entry & node_mask);
      for (std::uint32_t child = left; child < left + 2 && child < tree.size[level]; ++child) {
        const std::uint32_t last_leaf = ((child + 1) << level) - 1;
        if (last_leaf < from) continue;
        batch.visit();
        if (!overlap(box, tree.nodes[tree.first[level] + child])) continue;
        if (level > 0)
          stack[depth++] = level << level_shift | child;
        else if (child > slot)
          batch.add(tree.leaf_body[child]);
      }
    }
    batch.finish();
  }
};

/// The same query, with recursive calls.
template <class Sink>
struct DescendByCalls {
  LevelTree tree;
  bool whole;
  Sink sink;

  template <class Batch>
  SIM_HD void descend(const Aabb& box, std::uint32_t slot, std::uint32_t level, std::uint32_t node,
                      Batch& batch) const {
    for (std::uint32_t child = 2 * node; child < 2 * node + 2 && child < tree.size[level]; ++child) {
      const std::uint32_t last_leaf = ((child + 1) << level) - 1;
      if (last_leaf < (whole ? 0 : slot + 1)) continue;
      batch.visit();
      if (!overlap(box, tree.nodes[tree.first[level] + child])) continue;
      if (level > 0)
        descend(box, slot, level - 1, child, batch);
      else if (child > slot)
        batch.add(tree.leaf_body[child]);
    }
  }
  SIM_HD void operator()(int leaf) const {
    const auto slot = static_cast<std::uint32_t>(leaf);
    auto batch = start_query(sink, leaf, tree.leaf_body[slot]);
    if (tree.levels > 1)
      descend(tree.nodes[slot], slot, static_cast<std::uint32_t>(tree.levels - 2), 0, batch);
    batch.finish();
  }
};

struct WriteBottomUpTree {
  LevelTree tree;
  TreeSink sink;
  SIM_HD void operator()(int item) const {
    const auto node = static_cast<std::uint32_t>(item);
    sink.box[node] = tree.nodes[node];
    if (node < tree.size[0]) sink.leaf_body[node] = tree.leaf_body[node];
    int level = 0;
    while (node >= tree.first[level] + tree.size[level]) ++level;
    sink.parent[node] =
        level + 1 < tree.levels ? tree.first[level + 1] + (node - tree.first[level]) / 2 : node;
  }
};

template <class Emit>
struct ScatterById {
  Emit emit;
  SIM_HD void operator()(int body) const {
    emit(static_cast<std::uint32_t>(body), static_cast<std::uint32_t>(body));
  }
};

/// Replaces MortonOrder: each body's place is its id.
class InputOrder {
 public:
  explicit InputOrder(Executor& executor) : executor_(executor) {}
  void reserve(std::int64_t bodies) { bodies_ = bodies; }
  template <class Emit>
  void sort(const Aabb*, const Aabb*, const Emit& emit) {
    executor_.run("build", bodies_, ScatterById<Emit>{emit});
  }

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0;
};

/// Stack frame of one call on a GPU, bytes; an upper bound for compute capability 9.0.
constexpr std::size_t call_frame = 160;

template <class Order, template <class Sink> class Query = Descend>
class BvhBottomUp final : public BroadPhase {
 public:
  explicit BvhBottomUp(Executor& executor)
      : executor_(executor),
        order_(executor),
        leaf_body_(executor, "leaf bodies"),
        nodes_(executor, "tree nodes") {
    if constexpr (std::is_same_v<Query<PairSink>, DescendByCalls<PairSink>>)
      executor.reserve_call_stack(LevelTree::max_levels * call_frame);
  }

  void reserve(std::int64_t bodies) override {
    bodies_ = bodies;
    order_.reserve(bodies);
    leaf_body_.resize_discarding(static_cast<std::size_t>(bodies));
    tree_ = {};
    std::uint32_t total = 0;
    for (auto size = static_cast<std::uint32_t>(bodies); size > 0; size = (size + 1) / 2) {
      tree_.first[tree_.levels] = total;
      tree_.size[tree_.levels++] = size;
      total += size;
      if (size == 1) break;
    }
    nodes_.resize_discarding(total);
    tree_.nodes = nodes_.data();
    tree_.leaf_body = leaf_body_.data();
  }

  void update(const Aabb* boxes, const Aabb* extent) override {
    order_.sort(boxes, extent, MakeLeaf{boxes, nodes_.data(), leaf_body_.data()});
    for (int level = 1; level < tree_.levels; ++level)
      executor_.run("build", tree_.size[level],
                    MergeLevel{nodes_.data() + tree_.first[level - 1], tree_.size[level - 1],
                               nodes_.data() + tree_.first[level]});
  }

  void find_pairs(const PairSink& sink) override {
    executor_.run("pairs", bodies_, Query<PairSink>{tree_, executor_.options().whole_queries, sink});
  }
  void count_visits(const VisitSink& sink) const override {
    executor_.run("quality", bodies_, Query<VisitSink>{tree_, executor_.options().whole_queries, sink});
  }
  std::int64_t tree_nodes() const override { return static_cast<std::int64_t>(nodes_.size()); }
  void write_tree(const TreeSink& sink) const override {
    executor_.run("tree", tree_nodes(), WriteBottomUpTree{tree_, sink});
  }

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0;
  Order order_;
  Buffer<std::uint32_t> leaf_body_;
  Buffer<Aabb> nodes_;
  LevelTree tree_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_bvh_bottom_up(Executor& executor) {
  if (executor.options().key_bits == 63)
    return std::make_unique<BvhBottomUp<MortonOrder<std::uint64_t>>>(executor);
  return std::make_unique<BvhBottomUp<MortonOrder<std::uint32_t>>>(executor);
}

std::unique_ptr<BroadPhase> make_bvh_input_order(Executor& executor) {
  return std::make_unique<BvhBottomUp<InputOrder>>(executor);
}

std::unique_ptr<BroadPhase> make_bvh_recursive(Executor& executor) {
  if (executor.options().key_bits == 63)
    return std::make_unique<BvhBottomUp<MortonOrder<std::uint64_t>, DescendByCalls>>(executor);
  return std::make_unique<BvhBottomUp<MortonOrder<std::uint32_t>, DescendByCalls>>(executor);
}

}  // namespace collidoscope
