// BSP tree of bodies with planes of any direction, split level by level. Split rule: the normal is the
// principal axis of the node's centres, computed from 32 evenly spaced ones. The plane is at the median of
// the projections onto it. As in the k-d tree, bodies have extent: each node stores two planes, the end of
// its left half and the beginning of its right half.
//
// No pair is lost, without any safety margin. A box projects onto the interval
//   low = n.x * (n.x < 0 ? max : min).x + (same for y) + (same for z),  high: min and max exchanged,
// in float and in this order. Rounding is monotone: a <= b implies fl(n * a) <= fl(n * b) for n >= 0, and
// fl(a + c) <= fl(b + d) if also c <= d. Overlapping boxes A and B have a common point. Each term of A's low
// is at most that of the point, which is at most that of B's high. The rounded sums keep this order: low(A)
// <= high(B). The same holds for A and the maximum high of several boxes.
//
// |n| <= 1 per component, so products are finite. A sum that overflows does so monotonically: no NaN. All
// stages round alike (-ffp-contract=off, -fmad=false). Empty boxes do not extend the planes. Leaves are
// compared by their exact boxes.

#include <cmath>
#include <utility>

#include "sim_cuda/broad_phase/balanced_tree.h"
#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/sort.h"

namespace collidoscope {

namespace {

struct alignas(16) BspNode {
  float normal[3];
  SplitPosition split;
  /// Ends of the children's intervals as ordered_bits(), so that a minimum serves both: ~high of the left
  /// child, low of the right child. All ones if a child has only empty boxes; this reads as NaN.
  std::uint32_t left_max, right_min;
  float middle;  ///< projected mean of the centres
  std::uint32_t unused;

  SIM_HD float low(const float* min, const float* max) const {
    return term(0, max, min) + term(1, max, min) + term(2, max, min);
  }
  SIM_HD float high(const float* min, const float* max) const { return low(max, min); }
  SIM_HD float term(int k, const float* if_negative, const float* if_positive) const {
    return normal[k] * (normal[k] < 0 ? if_negative : if_positive)[k];
  }

  SIM_HD ChildOverlap overlapping_children(const BalancedLeaf& query) const {
    return {low(query.min, query.max) <= from_ordered_bits(~left_max),
            high(query.min, query.max) >= from_ordered_bits(right_min)};
  }
};
static_assert(sizeof(BspNode) == 32);

/// Moments of points about an origin; the matrix is stored as xx, yy, zz, xy, yz, zx.
struct Cloud {
  double sum[3] = {}, square[6] = {};
  std::uint32_t points = 0;

  SIM_HD void add(const double* p) {
    ++points;
    for (int k = 0; k < 3; ++k) {
      sum[k] += p[k];
      square[k] += p[k] * p[k];
      square[3 + k] += p[k] * p[(k + 1) % 3];
    }
  }
  /// Direction of largest variance: the largest column of the covariance matrix after six squarings. This
  /// equals 64 steps of the power method, started from every axis. The x axis if the points coincide.
  SIM_HD void principal_axis(float* axis) const {
    double m[6];
    for (int k = 0; k < 3; ++k) {
      m[k] = square[k] - sum[k] * sum[k] / points;
      m[3 + k] = square[3 + k] - sum[k] * sum[(k + 1) % 3] / points;
    }
    axis[0] = 1;
    axis[1] = axis[2] = 0;
    for (int squaring = 0;; ++squaring) {
      const double trace = m[0] + m[1] + m[2];
      if (!(trace > 0)) return;
      for (double& entry : m) entry /= trace;
      if (squaring == 6) break;
      const double xy = m[3] * m[3], yz = m[4] * m[4], zx = m[5] * m[5];
      const double squared[6] = {m[0] * m[0] + xy + zx,
                                 m[1] * m[1] + xy + yz,
                                 m[2] * m[2] + yz + zx,
                                 m[3] * (m[0] + m[1]) + m[5] * m[4],
                                 m[4] * (m[1] + m[2]) + m[3] * m[5],
                                 m[5] * (m[2] + m[0]) + m[4] * m[3]};
      for (int k = 0; k < 6; ++k) m[k] = squared[k];
    }
    const double columns[3][3] = {{m[0], m[3], m[5]}, {m[3], m[1], m[4]}, {m[5], m[4], m[2]}};
    const double* column = columns[m[0] >= m[1] && m[0] >= m[2] ? 0 : m[1] >= m[2] ? 1 : 2];
    const double length = std::sqrt(column[0] * column[0] + column[1] * column[1] + column[2] * column[2]);
    for (int k = 0; k < 3; ++k) axis[k] = clamp_to(static_cast<float>(column[k] / length), -1.0f, 1.0f);
  }
};

struct ChoosePlane {
  static constexpr std::uint32_t samples = 32;
  BalancedTree tree;
  int level;
  const Aabb* boxes;
  const std::uint32_t* order;
  BspNode* nodes;
  SIM_HD void operator()(int item) const {
    const auto number = static_cast<std::uint32_t>(item);
    const NodeRange range = tree.range(level, number);
    if (!range.inner()) return;
    const std::uint32_t size = range.end - range.first, points = min_of(size, samples);
    double origin[3];
    Cloud cloud;
    for (std::uint32_t i = 0; i < points; ++i) {
      const auto step = static_cast<std::uint32_t>((2 * std::uint64_t{i} + 1) * size / (2 * points));
      const Aabb box = boxes[order[range.first + step]];
      double point[3];
      for (int k = 0; k < 3; ++k) {
        point[k] = static_cast<double>(center_of(box, k));
        if (i == 0) origin[k] = point[k];
        point[k] -= origin[k];
      }
      cloud.add(point);
    }
    BspNode node;
    cloud.principal_axis(node.normal);
    double middle = 0;
    for (int k = 0; k < 3; ++k)
      middle += static_cast<double>(node.normal[k]) * (origin[k] + cloud.sum[k] / cloud.points);
    node.split = SplitPosition(range);
    node.left_max = node.right_min = ~0u;
    node.middle = static_cast<float>(middle);
    node.unused = 0;
    store_vectorized(&nodes[BalancedTree::heap(level, number)], node);
  }
};

/// Sort keys: node number, then the coordinate along the node's normal. Deeper levels leave fewer bits for
/// the coordinate, and have fewer bodies per node. The leading bits of a float are finest near 0, where the
/// median is.
struct MakePlaneKeys {
  BalancedTree tree;
  int level;
  const Aabb* boxes;
  const std::uint32_t* order;
  const BspNode* nodes;
  std::uint32_t* keys;
  SIM_HD void operator()(int item) const {
    const auto place = static_cast<std::uint32_t>(item), number = tree.node_at(level, place);
    float along = 0;
    if (tree.range(level, number).inner()) {
      const BspNode node = load_readonly(&nodes[BalancedTree::heap(level, number)]);
      const Aabb box = boxes[order[place]];
      for (int k = 0; k < 3; ++k) along += node.normal[k] * center_of(box, k);
      along -= node.middle;
    }
    keys[place] = static_cast<std::uint32_t>((std::uint64_t{number} << 32 | ordered_bits(along)) >> level);
  }
};

/// Extends the plane of the child that contains the body. Integer minimum, so the order of the updates does
/// not matter.
struct ExpandChildren {
  BalancedTree tree;
  int level;
  const Aabb* boxes;
  const std::uint32_t* order;
  BspNode* nodes;
  SIM_HD void operator()(int item) const {
    const auto place = static_cast<std::uint32_t>(item), number = tree.node_at(level, place);
    const Aabb box = boxes[order[place]];
    if (!tree.range(level, number).inner() || is_empty(box)) return;
    BspNode& node = nodes[BalancedTree::heap(level, number)];
    if (place < node.split.middle())
      lower_bits(&node.left_max, ~ordered_bits(node.high(box.min.data(), box.max.data())));
    else
      lower_bits(&node.right_min, ordered_bits(node.low(box.min.data(), box.max.data())));
  }
  /// Reads first, because few values are lower than the stored one.
  SIM_HD static void lower_bits(std::uint32_t* lowest, std::uint32_t value) {
    if (atomic_load(lowest) > value) atomic_min(lowest, value);
  }
};

struct StartOrder {
  std::uint32_t* order;
  SIM_HD void operator()(int place) const { order[place] = static_cast<std::uint32_t>(place); }
};

/// Writes a node as the bounding box of its children, from the last level up.
struct WriteBoxes {
  BalancedTree tree;
  int level;
  const BalancedLeaf* leaves;
  TreeSink sink;
  SIM_HD void operator()(int item) const {
    const auto node = static_cast<std::uint32_t>(item);
    const NodeRange range = tree.range(level, node);
    const std::uint32_t number = tree.number(range);
    if (level == 0) sink.parent[number] = number;
    if (!range.inner()) {
      if (level == 0) write_leaf(number);
      return;
    }
    Aabb around = Aabb::empty();
    for (std::uint32_t side = 0; side < 2; ++side) {
      const NodeRange child = tree.range(level + 1, 2 * node + side);
      const std::uint32_t from = tree.number(child);
      if (!child.inner()) write_leaf(from);
      around = combine(around, sink.box[from]);
      sink.parent[from] = number;
    }
    sink.box[number] = around;
  }
  SIM_HD void write_leaf(std::uint32_t place) const {
    sink.box[place] = leaves[place].box();
    sink.leaf_body[place] = leaves[place].body;
  }
};

class Bsp final : public BroadPhase {
 public:
  explicit Bsp(Executor& executor)
      : executor_(executor),
        keys_(executor, "sort keys"),
        sorted_keys_(executor, "sorted keys"),
        order_(executor, "bodies by node"),
        sorted_order_(executor, "bodies by node"),
        leaves_(executor, "tree leaves"),
        nodes_(executor, "tree nodes"),
        temporary_(executor, "sort workspace") {}

  void reserve(std::int64_t bodies) override {
    tree_ = BalancedTree(bodies);
    const auto n = static_cast<std::size_t>(bodies);
    for (Buffer<std::uint32_t>* each : {&keys_, &sorted_keys_, &order_, &sorted_order_})
      each->resize_discarding(n);
    leaves_.resize_discarding(n);
    nodes_.resize_discarding(tree_.heap_size());
    temporary_.resize_discarding(sort_temporary_bytes<std::uint32_t>(executor_, bodies, 32));
  }

  void update(const Aabb* boxes, const Aabb*) override {
    const std::int64_t n = tree_.n;
    std::uint32_t *order = order_.data(), *sorted = sorted_order_.data();
    executor_.run("build", n, StartOrder{order});
    for (int level = 0; level < tree_.levels; ++level) {
      executor_.run("build", std::int64_t{1} << level,
                    ChoosePlane{tree_, level, boxes, order, nodes_.data()});
      executor_.run("keys", n, MakePlaneKeys{tree_, level, boxes, order, nodes_.data(), keys_.data()});
      sort_by_key(executor_, "sort", n, 32, keys_.data(), sorted_keys_.data(), order, sorted,
                  temporary_.data(), temporary_.bytes());
      std::swap(order, sorted);
      executor_.run("build", n, ExpandChildren{tree_, level, boxes, order, nodes_.data()});
    }
    executor_.run("build", n, MakeBalancedLeaves{boxes, order, leaves_.data()});
  }

  void find_pairs(const PairSink& sink) override {
    executor_.run("pairs", tree_.n,
                  TraverseBalanced<BspNode, PairSink>{nodes_.data(), leaves_.data(), tree_.n, sink});
  }
  void count_visits(const VisitSink& sink) const override {
    executor_.run("quality", tree_.n,
                  TraverseBalanced<BspNode, VisitSink>{nodes_.data(), leaves_.data(), tree_.n, sink});
  }

  std::int64_t tree_nodes() const override { return tree_.n > 0 ? 2 * std::int64_t{tree_.n} - 1 : 0; }
  void write_tree(const TreeSink& sink) const override {
    for (int level = tree_.levels > 0 ? tree_.levels - 1 : 0; tree_.n > 0 && level >= 0; --level)
      executor_.run("tree", std::int64_t{1} << level, WriteBoxes{tree_, level, leaves_.data(), sink});
  }

 private:
  Executor& executor_;
  BalancedTree tree_;
  Buffer<std::uint32_t> keys_, sorted_keys_, order_, sorted_order_;
  Buffer<BalancedLeaf> leaves_;
  Buffer<BspNode> nodes_;
  Buffer<std::byte> temporary_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_bsp(Executor& executor) { return std::make_unique<Bsp>(executor); }

}  // namespace collidoscope
