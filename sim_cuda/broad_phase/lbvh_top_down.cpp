// A linear BVH built from the root down, after Lauterbach et al. 2009; the paper times this method in its
// Table 3. Bodies are in Morton order. Nodes are split level by level from a work queue. A node is split
// where the highest differing bit of its keys changes from 0 to 1. Levels near the root have little work, so
// most threads are idle. Then leaves climb to compute the boxes. A query descends from the root with a stack.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/morton_order.h"
#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/vector_load.h"

namespace collidoscope {

namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};
constexpr std::uint32_t leaf_flag = 1u << 31;

/// Nodes are stored in queue order: level by level, the root first, the two children of a node adjacent.
struct alignas(16) QueueNode {
  float min[3];
  std::uint32_t child;  ///< left child; for a leaf: leaf_flag and the id of its body
  float max[3];
  std::uint32_t last;  ///< last place in Morton order below the node
};
static_assert(sizeof(QueueNode) == 32);

SIM_HD inline bool overlap(const QueueNode& a, const QueueNode& b) {
  return a.min[0] <= b.max[0] && b.min[0] <= a.max[0] && a.min[1] <= b.max[1] && b.min[1] <= a.max[1] &&
         a.min[2] <= b.max[2] && b.min[2] <= a.max[2];
}

/// The queue: first node and number of nodes of each level.
struct Levels {
  std::uint32_t *begin, *size;
};

struct PutRoot {
  std::uint32_t n;
  Levels levels;
  std::uint32_t *first, *parent;
  QueueNode* nodes;
  SIM_HD void operator()(int) const {
    levels.begin[0] = 0;
    levels.size[0] = 1;
    first[0] = 0;
    parent[0] = none;
    nodes[0].last = n - 1;
  }
};

/// One round per level (Executor::run_rounds). Empty rounds, beyond the depth of the tree, cost nothing.
template <class Key>
struct SplitNodes {
  const Key* keys;
  const std::uint32_t* order;
  Levels levels;
  std::uint32_t *first, *parent, *arrival, *leaf_of_place;
  QueueNode* nodes;

  SIM_HD std::int64_t items(int level) const { return levels.size[level]; }

  /// Last place of the left part. The next place is the first one with the highest differing bit set.
  SIM_HD std::uint32_t split(std::uint32_t low, std::uint32_t high) const {
    Key differ = keys[low] ^ keys[high];
    if (differ == 0) return low + (high - low) / 2;
    while (differ & (differ - 1)) differ &= differ - 1;  // keeps the highest bit
    while (high - low > 1) {
      const std::uint32_t middle = low + (high - low) / 2;
      (keys[middle] & differ ? high : low) = middle;
    }
    return low;
  }

  SIM_HD void operator()(int level, int item) const {
    const std::uint32_t begin = levels.begin[level], next = begin + levels.size[level];
    if (item == 0) levels.begin[level + 1] = next;
    const std::uint32_t node = begin + static_cast<std::uint32_t>(item);
    const std::uint32_t low = first[node], high = nodes[node].last;
    arrival[node] = none;
    if (low == high) {
      nodes[node].child = leaf_flag | order[low];
      leaf_of_place[low] = node;
      return;
    }
    const std::uint32_t at = split(low, high);
    const std::uint32_t child = next + atomic_add(&levels.size[level + 1], 2);
    nodes[node].child = child;
    first[child] = low;
    nodes[child].last = at;
    first[child + 1] = at + 1;
    nodes[child + 1].last = high;
    parent[child] = parent[child + 1] = node;
  }
};

/// Splits one level in a separate launch.
template <class Key>
struct SplitLevel {
  SplitNodes<Key> nodes;
  int level;
  SIM_HD void operator()(int item) const { nodes(level, item); }
};

/// Computes all boxes: leaves climb, and the second child to arrive continues.
struct Refit {
  const Aabb* boxes;
  const std::uint32_t* parent;
  std::uint32_t* arrival;
  QueueNode* nodes;
  const std::uint32_t* leaf_of_place;
  SIM_HD void operator()(int place) const {
    std::uint32_t at = leaf_of_place[place];
    QueueNode node = nodes[at];
    const Aabb box = boxes[node.child & ~leaf_flag];
    for (int k = 0; k < 3; ++k) {
      node.min[k] = box.min[k];
      node.max[k] = box.max[k];
    }
    for (;;) {
      store_vectorized(&nodes[at], node);
      const std::uint32_t above = parent[at];
      if (above == none || atomic_exchange(&arrival[above], at) == none) return;
      const QueueNode up = nodes[above];
      const QueueNode other = load_l2(&nodes[at == up.child ? at + 1 : at - 1]);
      for (int k = 0; k < 3; ++k) {
        node.min[k] = min_of(node.min[k], other.min[k]);
        node.max[k] = max_of(node.max[k], other.max[k]);
      }
      node.child = up.child;
      node.last = up.last;
      at = above;
    }
  }
};

/// One body's query. Half traversal reports only leaves to the right of the body's own, so each pair is found
/// once. With `whole`, the query visits all overlapping nodes, and skips leaves to the left.
template <int depth, class Sink>
struct DescendFromRoot {
  const QueueNode* nodes;
  const std::uint32_t* leaf_of_place;
  bool whole;
  Sink sink;
  SIM_HD void operator()(int item) const {
    const auto place = static_cast<std::uint32_t>(item), from = whole ? 0 : place + 1;
    const QueueNode query = load_readonly(&nodes[leaf_of_place[place]]);
    auto batch = start_query(sink, item, query.child & ~leaf_flag);
    // A node is popped before its children are pushed. So the stack holds at most one entry per level, plus
    // one.
    std::uint32_t stack[depth + 1];
    int stacked = 0;
    const std::uint32_t root_child = nodes[0].child;
    if (!(root_child & leaf_flag)) stack[stacked++] = root_child;
    while (stacked > 0) {
      const std::uint32_t child = stack[--stacked];
      for (std::uint32_t at = child; at < child + 2; ++at) {
        const QueueNode node = load_readonly(&nodes[at]);
        batch.visit();
        if (node.last < from || !overlap(query, node)) continue;
        if (!(node.child & leaf_flag))
          stack[stacked++] = node.child;
        else if (node.last > place)
          batch.add(node.child & ~leaf_flag);
      }
    }
    batch.finish();
  }
};

struct WriteTopDownTree {
  const QueueNode* nodes;
  const std::uint32_t *parent, *number;
  TreeSink sink;
  SIM_HD void operator()(int item) const {
    const QueueNode node = nodes[item];
    const std::uint32_t to = number[item];
    Aabb box;
    for (int k = 0; k < 3; ++k) {
      box.min[k] = node.min[k];
      box.max[k] = node.max[k];
    }
    sink.box[to] = box;
    sink.parent[to] = parent[item] == none ? to : number[parent[item]];
    if (node.child & leaf_flag) sink.leaf_body[to] = node.child & ~leaf_flag;
  }
};

/// TreeSink numbers: leaves by place; the inner node that splits after place k has the number n + k.
struct NumberNodes {
  const QueueNode* nodes;
  std::uint32_t n;
  std::uint32_t* number;
  SIM_HD void operator()(int item) const {
    const QueueNode node = nodes[item];
    number[item] = node.child & leaf_flag ? node.last : n + nodes[node.child].last;
  }
};

template <class Key>
class LbvhTopDown final : public BroadPhase {
 public:
  explicit LbvhTopDown(Executor& executor)
      : executor_(executor),
        order_(executor),
        levels_(executor, "queue levels"),
        first_(executor, "first leaves of nodes"),
        parent_(executor, "node parents"),
        arrival_(executor, "arrival counters"),
        leaf_(executor, "leaf nodes"),
        nodes_(executor, "tree nodes") {}

  void reserve(std::int64_t bodies) override {
    n_ = static_cast<std::uint32_t>(bodies);
    order_.reserve(bodies);
    leaf_.resize_discarding(n_);
    levels_.resize_discarding(2 * (max_levels + 1));
    const std::size_t nodes = n_ > 0 ? 2 * static_cast<std::size_t>(n_) - 1 : 0;
    for (Buffer<std::uint32_t>* numbers : {&first_, &parent_, &arrival_}) numbers->resize_discarding(nodes);
    nodes_.resize_discarding(nodes);
  }

  void update(const Aabb* boxes, const Aabb* extent) override {
    if (n_ == 0) return;
    order_.sort(boxes, extent);
    const Levels levels{levels_.data(), levels_.data() + max_levels + 1};
    executor_.begin_stage("build");
    levels_.fill_zero();
    executor_.run("build", 1, PutRoot{n_, levels, first_.data(), parent_.data(), nodes_.data()});
    const SplitNodes<Key> split{order_.keys(),  order_.bodies(), levels,       first_.data(),
                                parent_.data(), arrival_.data(), leaf_.data(), nodes_.data()};
    if (executor_.on_device() && n_ > max_in_rounds) {
      for (int level = 0; level < levels_needed(); ++level)
        executor_.run("build", ItemCount(levels.size + level, max_level_size(level)),
                      SplitLevel<Key>{split, level});
    } else {
      executor_.run_rounds("build", levels_needed(), n_, split);
    }
    executor_.run("build", n_, Refit{boxes, parent_.data(), arrival_.data(), nodes_.data(), leaf_.data()});
  }

  void find_pairs(const PairSink& sink) override { executor_.run("pairs", n_, query(sink)); }
  void count_visits(const VisitSink& sink) const override { executor_.run("quality", n_, query(sink)); }

  std::int64_t tree_nodes() const override { return static_cast<std::int64_t>(nodes_.size()); }
  void write_tree(const TreeSink& sink) const override {
    Buffer<std::uint32_t> number(executor_, "node numbers");
    number.resize_discarding(nodes_.size());
    executor_.run("tree", tree_nodes(), NumberNodes{nodes_.data(), n_, number.data()});
    executor_.run("tree", tree_nodes(), WriteTopDownTree{nodes_.data(), parent_.data(), number.data(), sink});
    executor_.synchronize();
  }

 private:
  // With more bodies, each level is a separate launch on a GPU, including empty levels. Rounds in one launch
  // have one block per multiprocessor, which is too few: 1.23 ms instead of 0.48 for 1,000,000 bodies on an
  // H200.
  static constexpr std::uint32_t max_in_rounds = 200'000;
  /// Upper bound of the nodes of a level.
  std::int64_t max_level_size(int level) const {
    const std::int64_t nodes = tree_nodes();
    return level < 40 && (std::int64_t{1} << level) < nodes ? std::int64_t{1} << level : nodes;
  }
  // One level per key bit, then equal keys are halved.
  static constexpr int max_levels = (sizeof(Key) == 4 ? 30 : 63) + 28;
  int levels_needed() const {
    int halvings = 0;
    while ((std::uint64_t{1} << halvings) < n_) ++halvings;
    return order_.key_bits() + halvings + 1;
  }
  template <class Sink>
  DescendFromRoot<max_levels, Sink> query(const Sink& sink) const {
    return {nodes_.data(), leaf_.data(), executor_.options().whole_queries, sink};
  }

  Executor& executor_;
  std::uint32_t n_ = 0;
  MortonOrder<Key> order_;
  Buffer<std::uint32_t> levels_, first_, parent_, arrival_, leaf_;
  Buffer<QueueNode> nodes_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_lbvh_top_down(Executor& executor) {
  if (executor.options().key_bits == 63) return std::make_unique<LbvhTopDown<std::uint64_t>>(executor);
  return std::make_unique<LbvhTopDown<std::uint32_t>>(executor);
}

}  // namespace collidoscope
