#include "sim_cuda/broad_phase/tree.h"

#include <bit>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/sort.h"
#include "sim_cuda/import/tree_file.h"

namespace collidoscope {

namespace {

/// Propagates a leaf's place to its ancestors, which keep the minimum. Stops at an ancestor with a smaller
/// value, because that value has already been propagated.
struct PropagateLeftmost {
  const std::uint32_t* parent;
  std::uint32_t* leftmost;
  SIM_HD void operator()(int leaf) const {
    const auto place = static_cast<std::uint32_t>(leaf);
    leftmost[leaf] = place;
    for (std::uint32_t node = place; parent[node] != node;) {
      node = parent[node];
      if (!atomic_min(&leftmost[node], place)) return;
    }
  }
};

struct MakeTreeKeys {
  const std::uint32_t *parent, *leftmost;
  std::uint64_t *key, *deepest;
  std::uint32_t* id;
  SIM_HD void operator()(int item) const {
    std::uint64_t depth = 0;
    for (auto node = static_cast<std::uint32_t>(item); parent[node] != node; ++depth) node = parent[node];
    atomic_max(deepest, depth);
    key[item] = depth << 32 | leftmost[item];
    id[item] = static_cast<std::uint32_t>(item);
  }
};

struct InvertOrder {
  const std::uint32_t* order;
  std::uint32_t* place;
  SIM_HD void operator()(int k) const { place[order[k]] = static_cast<std::uint32_t>(k); }
};

struct MoveNodes {
  const std::uint32_t *order, *place;
  std::uint32_t leaves;
  const Aabb* raw_box;
  const std::uint32_t *raw_parent, *leaf_body;
  const std::uint64_t* key;
  Aabb* box;
  std::uint32_t *parent, *first_child, *children, *body, *level_first;
  SIM_HD void operator()(int k) const {
    const std::uint32_t node = order[k];
    box[k] = raw_box[node];
    parent[k] = place[raw_parent[node]];
    body[k] = node < leaves ? leaf_body[node] : TreeView::inner;
    first_child[k] = TreeView::inner;
    children[k] = 0;
    if (k == 0 || level(k - 1) != level(k)) level_first[level(k)] = static_cast<std::uint32_t>(k);
  }
  SIM_HD std::uint32_t level(int k) const {
    return min_of(static_cast<std::uint32_t>(key[k] >> 32), std::uint32_t{TreeView::last_level});
  }
};

struct FindChildren {
  const std::uint32_t* parent;
  std::uint32_t nodes;
  std::uint32_t *first_child, *children;
  SIM_HD void operator()(int item) const {
    const auto k = static_cast<std::uint32_t>(item) + 1;  // skips the root
    const std::uint32_t above = parent[k];
    if (k > 1 && parent[k - 1] == above) return;
    std::uint32_t last = k + 1;
    while (last < nodes && parent[last] == above) ++last;
    first_child[above] = k;
    children[above] = last - k;
  }
};

}  // namespace

Tree::Tree(Executor& executor)
    : executor_(executor),
      raw_box_(executor, "tree boxes"),
      box_(executor, "tree boxes"),
      raw_parent_(executor, "tree parents"),
      leaf_body_(executor, "leaf bodies"),
      leftmost_(executor, "leftmost leaves"),
      deepest_(executor, "tree depth"),
      key_(executor, "node keys"),
      sorted_key_(executor, "node keys"),
      id_(executor, "node numbers"),
      order_(executor, "node order"),
      place_(executor, "node ranks"),
      parent_(executor, "tree parents"),
      first_child_(executor, "tree children"),
      children_(executor, "tree children"),
      body_(executor, "node bodies"),
      level_first_(executor, "tree levels"),
      temporary_(executor, "sort workspace") {}

void write_given_tree(Executor& executor, const GivenTree& tree, const TreeSink& sink) {
  const auto copy = [&](auto* to, const auto& from) {
    executor.copy_to_executor(to, from.data(), from.size() * sizeof from[0]);
  };
  copy(sink.box, tree.box);
  copy(sink.parent, tree.parent);
  copy(sink.leaf_body, tree.leaf_body);
}

void Tree::build_level_order(const BroadPhase& method, std::int64_t bodies) {
  view_ = {};
  const std::int64_t nodes = method.tree_nodes();
  if (nodes == 0) return;
  const auto n = static_cast<std::size_t>(nodes);
  for (Buffer<Aabb>* boxes : {&raw_box_, &box_}) boxes->resize_discarding(n);
  for (Buffer<std::uint64_t>* keys : {&key_, &sorted_key_}) keys->resize_discarding(n);
  for (Buffer<std::uint32_t>* numbers :
       {&raw_parent_, &leftmost_, &id_, &order_, &place_, &parent_, &first_child_, &children_, &body_})
    numbers->resize_discarding(n);
  leaf_body_.resize_discarding(static_cast<std::size_t>(bodies));
  deepest_.resize_discarding(1);
  level_first_.resize_discarding(TreeView::last_level + 1);

  executor_.begin_stage("tree");
  method.write_tree({raw_box_.data(), raw_parent_.data(), leaf_body_.data()});
  executor_.fill(leftmost_.data(), 0xff, leftmost_.bytes());
  executor_.fill(level_first_.data(), 0xff, level_first_.bytes());
  executor_.run("tree", bodies, PropagateLeftmost{raw_parent_.data(), leftmost_.data()});
  deepest_.fill_zero();
  executor_.run("tree", nodes,
                MakeTreeKeys{raw_parent_.data(), leftmost_.data(), key_.data(), deepest_.data(), id_.data()});
  const int key_bits = 32 + static_cast<int>(std::bit_width(deepest_.download()[0]));
  temporary_.resize_discarding(sort_temporary_bytes<std::uint64_t>(executor_, nodes, key_bits));
  sort_by_key(executor_, "tree", nodes, key_bits, key_.data(), sorted_key_.data(), id_.data(), order_.data(),
              temporary_.data(), temporary_.bytes());
  executor_.run("tree", nodes, InvertOrder{order_.data(), place_.data()});
  executor_.run(
      "tree", nodes,
      MoveNodes{order_.data(), place_.data(), static_cast<std::uint32_t>(bodies), raw_box_.data(),
                raw_parent_.data(), leaf_body_.data(), sorted_key_.data(), box_.data(), parent_.data(),
                first_child_.data(), children_.data(), body_.data(), level_first_.data()});
  executor_.run(
      "tree", nodes - 1,
      FindChildren{parent_.data(), static_cast<std::uint32_t>(nodes), first_child_.data(), children_.data()});
  first_ = level_first_.download();
  while (first_.back() == TreeView::inner) first_.pop_back();
  first_.push_back(static_cast<std::uint32_t>(nodes));
  view_ = {nodes,        box_.data(),       parent_.data(), first_child_.data(), children_.data(),
           body_.data(), leaf_body_.data(), &first_};
}

}  // namespace collidoscope
