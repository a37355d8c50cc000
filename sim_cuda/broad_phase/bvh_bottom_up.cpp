// The paper's hierarchy: bodies in Morton order are the leaves; each level merges every two consecutive nodes
// of the one below (its Figure 7), until one is left. The tree is implicit (node i has the children 2i and
// 2i+1 of the level below), so building it needs no queue and no atomics: one launch a level. A body's query
// descends from the root with a stack in local memory (its 3.2.4).

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/morton.h"
#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/sort.h"

namespace collidoscope {

namespace {

template <class Key>
struct MakeKeys {
  const Aabb* boxes;
  const Aabb* extent;
  Key* keys;
  std::uint32_t* ids;
  SIM_HD void operator()(int body) const {
    keys[body] = morton_key<Key>(boxes[body], *extent);
    ids[body] = static_cast<std::uint32_t>(body);
  }
};

struct GatherLeaves {
  const Aabb* boxes;
  const std::uint32_t* leaf_body;
  Aabb* leaves;
  SIM_HD void operator()(int leaf) const { leaves[leaf] = boxes[leaf_body[leaf]]; }
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

/// One body's query. Only leaves to the right of its own are looked for, so that each pair is found once,
/// from its left leaf.
struct Descend {
  TreeView tree;
  PairSink sink;
  SIM_HD void operator()(int leaf) const {
    const auto slot = static_cast<std::uint32_t>(leaf);
    const Aabb box = tree.nodes[slot];
    const std::uint32_t body = tree.leaf_body[slot];
    // An entry is (level, node in level), of a node that overlaps. A node pops before its two children push,
    // so the stack never holds more than one entry per level, plus one.
    constexpr int level_shift = 27;
    constexpr std::uint32_t node_mask = (1u << level_shift) - 1;
    std::uint32_t stack[TreeView::max_levels + 1];
    int depth = 0;
    if (tree.levels > 1) stack[depth++] = static_cast<std::uint32_t>(tree.levels - 1) << level_shift;
    while (depth > 0) {
      const std::uint32_t entry = stack[--depth];
      const std::uint32_t level = (entry >> level_shift) - 1;  // of the children
      const std::uint32_t left = 2 * (entry & node_mask);
      for (std::uint32_t child = left; child < left + 2 && child < tree.size[level]; ++child) {
        const std::uint32_t last_leaf = ((child + 1) << level) - 1;
        if (last_leaf <= slot || !overlap(box, tree.nodes[tree.first[level] + child])) continue;
        if (level == 0)
          sink.add(body, tree.leaf_body[child]);
        else
          stack[depth++] = level << level_shift | child;
      }
    }
  }
};

template <class Key>
class BvhBottomUp final : public BroadPhase {
 public:
  explicit BvhBottomUp(Executor& executor)
      : executor_(executor),
        keys_(executor, "Morton keys"),
        sorted_keys_(executor, "sorted Morton keys"),
        ids_(executor, "ids to sort"),
        leaf_body_(executor, "leaf bodies"),
        nodes_(executor, "tree nodes"),
        temporary_(executor, "sort workspace") {}

  void reserve(std::int64_t bodies) override {
    bodies_ = bodies;
    const auto count = static_cast<std::size_t>(bodies);
    keys_.resize_discarding(count);
    sorted_keys_.resize_discarding(count);
    ids_.resize_discarding(count);
    leaf_body_.resize_discarding(count);
    temporary_.resize_discarding(sort_temporary_bytes<Key>(executor_, bodies, key_bits));
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
    executor_.run("keys", bodies_, MakeKeys<Key>{boxes, extent, keys_.data(), ids_.data()});
    sort_by_key(executor_, "sort", bodies_, key_bits, keys_.data(), sorted_keys_.data(), ids_.data(),
                leaf_body_.data(), temporary_.data(), temporary_.bytes());
    executor_.run("build", bodies_, GatherLeaves{boxes, leaf_body_.data(), nodes_.data()});
    for (int level = 1; level < tree_.levels; ++level)
      executor_.run("build", tree_.size[level],
                    MergeLevel{nodes_.data() + tree_.first[level - 1], tree_.size[level - 1],
                               nodes_.data() + tree_.first[level]});
  }

  void find_pairs(const PairSink& sink) override { executor_.run("pairs", bodies_, Descend{tree_, sink}); }
  TreeView tree() const override { return tree_; }

 private:
  static constexpr int key_bits = sizeof(Key) == 4 ? 30 : 63;
  Executor& executor_;
  std::int64_t bodies_ = 0;
  Buffer<Key> keys_, sorted_keys_;
  Buffer<std::uint32_t> ids_, leaf_body_;
  Buffer<Aabb> nodes_;
  Buffer<std::byte> temporary_;
  TreeView tree_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_bvh_bottom_up(Executor& executor) {
  if (executor.options().key_bits == 63) return std::make_unique<BvhBottomUp<std::uint64_t>>(executor);
  return std::make_unique<BvhBottomUp<std::uint32_t>>(executor);
}

}  // namespace collidoscope
