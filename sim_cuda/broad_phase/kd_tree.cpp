// k-d tree of bodies, split level by level. Split rule: the object median of the centres along the axis of
// largest spread; ties by id. Bodies have extent and would straddle a plane. Each node therefore stores two
// planes, as in a bounding interval hierarchy (Waechter and Keller 2006): the end of its left half and the
// beginning of its right half. The halves may overlap or leave a gap. No body is split or duplicated. A query
// compares one coordinate with each plane; this is exact, so no pair is lost.
//
// The bodies are sorted along each axis once. A node's centres are then contiguous in three lists, each
// sorted along one axis. The first and last entry of each list give the spread, and its middle gives the
// median. Each level partitions the three lists stably by a scan (Wald and Havran 2006, on the CPU). The
// shape depends on n only (balanced_tree.h), so each level is a fixed number of launches.

#include <algorithm>
#include <utility>

#include "sim_cuda/broad_phase/balanced_tree.h"
#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/scan.h"
#include "sim_cuda/core/sort.h"

namespace collidoscope {

namespace {

struct alignas(16) KdNode {
  float left_max, right_min;  ///< m, along the axis: end of the left half, beginning of the right half
  SplitPosition split;
  std::uint32_t axis;

  SIM_HD ChildOverlap overlapping_children(const BalancedLeaf& query) const {
    return {query.min[axis] <= left_max, query.max[axis] >= right_min};
  }
};
static_assert(sizeof(KdNode) == 16);

struct MakeAxisKeys {
  const Aabb* boxes;
  int axis;
  std::uint32_t *keys, *ids;
  SIM_HD void operator()(int body) const {
    keys[body] = ordered_bits(center_of(boxes[body], axis));
    ids[body] = static_cast<std::uint32_t>(body);
  }
};

/// Body ids in three lists: sorted within each node along x, then along y, then along z.
struct AxisLists {
  BalancedTree tree;
  const std::uint32_t* bodies;
  SIM_HD std::uint32_t body(std::uint32_t axis, std::uint32_t place) const {
    return bodies[axis * tree.n + place];
  }
};

struct ChooseAxis {
  AxisLists lists;
  int level;
  const Aabb* boxes;
  KdNode* nodes;
  SIM_HD void operator()(int item) const {
    const auto node = static_cast<std::uint32_t>(item);
    const NodeRange range = lists.tree.range(level, node);
    float longest = -1;
    std::uint32_t axis = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto coordinate = [&](std::uint32_t place) {
        return center_of(boxes[lists.body(k, place)], static_cast<int>(k));
      };
      const float spread = coordinate(range.end - 1) - coordinate(range.first);
      if (!(spread > longest)) continue;
      longest = spread;
      axis = k;
    }
    nodes[BalancedTree::heap(level, node)].axis = axis;
  }
};

/// Writes the side of each body, using the list of its node's split axis.
struct ChooseSide {
  AxisLists lists;
  int level;
  const KdNode* nodes;
  std::uint32_t* goes_left;  ///< by body: 1 or 0
  SIM_HD void operator()(int item) const {
    const auto place = static_cast<std::uint32_t>(item);
    const std::uint32_t node = lists.tree.node_at(level, place);
    const std::uint32_t axis = nodes[BalancedTree::heap(level, node)].axis;
    goes_left[lists.body(axis, place)] = place < lists.tree.begin(level + 1, 2 * node + 1);
  }
};

struct ListSides {
  const std::uint32_t *bodies, *goes_left;
  std::uint32_t* left;
  SIM_HD void operator()(int entry) const { left[entry] = goes_left[bodies[entry]]; }
};

struct PartitionLists {
  AxisLists lists;
  int level;
  const std::uint32_t *left, *lefts_before;
  std::uint32_t* partitioned;
  SIM_HD void operator()(int item) const {
    const auto entry = static_cast<std::uint32_t>(item);
    const std::uint32_t list = entry / lists.tree.n * lists.tree.n, place = entry - list;
    const NodeRange range = lists.tree.range(level, lists.tree.node_at(level, place));
    const std::uint32_t lefts = lefts_before[entry] - lefts_before[list + range.first];
    const std::uint32_t to =
        left[entry] != 0 ? range.first + lefts : range.middle + (place - range.first - lefts);
    partitioned[list + to] = lists.bodies[entry];
  }
};

/// From the last level up: computes each node's box, and its two planes on the split axis.
struct MergeChildren {
  BalancedTree tree;
  int level;
  const BalancedLeaf* leaves;
  Aabb* boxes;
  KdNode* nodes;
  SIM_HD Aabb box_of(std::uint32_t node) const {
    const std::uint32_t first = tree.begin(level + 1, node);
    return tree.begin(level + 1, node + 1) - first == 1 ? leaves[first].box()
                                                        : boxes[BalancedTree::heap(level + 1, node)];
  }
  SIM_HD void operator()(int item) const {
    const auto node = static_cast<std::uint32_t>(item), at = BalancedTree::heap(level, node);
    const NodeRange range = tree.range(level, node);
    if (!range.inner()) return;
    const Aabb left = box_of(2 * node), right = box_of(2 * node + 1);
    const std::uint32_t axis = nodes[at].axis;
    boxes[at] = combine(left, right);
    store_vectorized(&nodes[at], KdNode{left.max[axis], right.min[axis], SplitPosition(range), axis});
  }
};

/// Writes a node as the region that its planes leave of the parent's region, starting with the root's box.
/// This is the region that a query enters.
struct WriteRegions {
  BalancedTree tree;
  int level;
  const KdNode* nodes;
  const BalancedLeaf* leaves;
  const Aabb* root;
  TreeSink sink;
  SIM_HD void operator()(int item) const {
    const auto node = static_cast<std::uint32_t>(item);
    const NodeRange range = tree.range(level, node);
    if (!range.inner()) return;
    const KdNode from = nodes[BalancedTree::heap(level, node)];
    const std::uint32_t number = tree.number(range);
    if (level == 0) {
      sink.box[number] = *root;
      sink.parent[number] = number;
    }
    for (std::uint32_t side = 0; side < 2; ++side) {
      const NodeRange child = tree.range(level + 1, 2 * node + side);
      const std::uint32_t to = tree.number(child);
      Aabb box = sink.box[number];
      (side == 0 ? box.max : box.min)[from.axis] = side == 0 ? from.left_max : from.right_min;
      if (!child.inner()) {
        box = leaves[to].box();
        sink.leaf_body[to] = leaves[to].body;
      }
      sink.box[to] = box;
      sink.parent[to] = number;
    }
  }
};

struct WriteOneLeaf {
  const BalancedLeaf* leaf;
  TreeSink sink;
  SIM_HD void operator()(int) const {
    sink.box[0] = leaf->box();
    sink.parent[0] = 0;
    sink.leaf_body[0] = leaf->body;
  }
};

class KdTree final : public BroadPhase {
 public:
  explicit KdTree(Executor& executor)
      : executor_(executor),
        keys_(executor, "sort keys"),
        sorted_keys_(executor, "sorted keys"),
        ids_(executor, "unsorted ids"),
        lists_(executor, "bodies sorted by axis"),
        partitioned_(executor, "bodies sorted by axis"),
        side_(executor, "partition sides"),
        left_(executor, "left partition counts"),
        before_(executor, "left partition counts"),
        leaves_(executor, "tree leaves"),
        nodes_(executor, "tree nodes"),
        boxes_(executor, "tree boxes"),
        temporary_(executor, "sort workspace") {}

  void reserve(std::int64_t bodies) override {
    tree_ = BalancedTree(bodies);
    const auto n = static_cast<std::size_t>(bodies);
    for (Buffer<std::uint32_t>* each : {&keys_, &sorted_keys_, &ids_, &side_}) each->resize_discarding(n);
    for (Buffer<std::uint32_t>* each : {&lists_, &partitioned_}) each->resize_discarding(3 * n);
    for (Buffer<std::uint32_t>* each : {&left_, &before_}) each->resize_discarding(3 * n + 1);
    leaves_.resize_discarding(n);
    nodes_.resize_discarding(tree_.heap_size());
    boxes_.resize_discarding(tree_.heap_size());
    temporary_.resize_discarding(std::max(sort_temporary_bytes<std::uint32_t>(executor_, bodies, 32),
                                          scan_temporary_bytes(executor_, 3 * bodies)));
  }

  void update(const Aabb* boxes, const Aabb*) override {
    const std::int64_t n = tree_.n;
    if (n == 0) return;
    for (int axis = 0; axis < 3; ++axis) {
      executor_.run("keys", n, MakeAxisKeys{boxes, axis, keys_.data(), ids_.data()});
      sort_by_key(executor_, "sort", n, 32, keys_.data(), sorted_keys_.data(), ids_.data(),
                  lists_.data() + axis * n, temporary_.data(), temporary_.bytes());
    }
    std::uint32_t *list = lists_.data(), *partitioned = partitioned_.data();
    for (int level = 0; level < tree_.levels; ++level) {
      const AxisLists lists{tree_, list};
      executor_.run("build", std::int64_t{1} << level, ChooseAxis{lists, level, boxes, nodes_.data()});
      executor_.run("build", n, ChooseSide{lists, level, nodes_.data(), side_.data()});
      executor_.run("build", 3 * n, ListSides{list, side_.data(), left_.data()});
      exclusive_scan(executor_, "build", 3 * n, left_.data(), before_.data(), temporary_.data(),
                     temporary_.bytes());
      executor_.run("build", 3 * n, PartitionLists{lists, level, left_.data(), before_.data(), partitioned});
      std::swap(list, partitioned);
    }
    executor_.run("build", n, MakeBalancedLeaves{boxes, list, leaves_.data()});
    for (int up = 1; up <= tree_.levels; ++up) {
      const int level = tree_.levels - up;
      executor_.run("build", std::int64_t{1} << level,
                    MergeChildren{tree_, level, leaves_.data(), boxes_.data(), nodes_.data()});
    }
  }

  void find_pairs(const PairSink& sink) override {
    executor_.run("pairs", tree_.n,
                  TraverseBalanced<KdNode, PairSink>{nodes_.data(), leaves_.data(), tree_.n, sink});
  }
  void count_visits(const VisitSink& sink) const override {
    executor_.run("quality", tree_.n,
                  TraverseBalanced<KdNode, VisitSink>{nodes_.data(), leaves_.data(), tree_.n, sink});
  }

  std::int64_t tree_nodes() const override { return tree_.n > 0 ? 2 * std::int64_t{tree_.n} - 1 : 0; }
  void write_tree(const TreeSink& sink) const override {
    if (tree_.n == 1) executor_.run("tree", 1, WriteOneLeaf{leaves_.data(), sink});
    for (int level = 0; level < tree_.levels; ++level)
      executor_.run("tree", std::int64_t{1} << level,
                    WriteRegions{tree_, level, nodes_.data(), leaves_.data(), boxes_.data() + 1, sink});
  }

 private:
  Executor& executor_;
  BalancedTree tree_;
  Buffer<std::uint32_t> keys_, sorted_keys_, ids_, lists_, partitioned_, side_, left_, before_;
  Buffer<BalancedLeaf> leaves_;
  Buffer<KdNode> nodes_;
  Buffer<Aabb> boxes_;
  Buffer<std::byte> temporary_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_kd_tree(Executor& executor) { return std::make_unique<KdTree>(executor); }

}  // namespace collidoscope
