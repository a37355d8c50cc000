#pragma once
// Brute-force statistics of a tree, the expected values for the tree measurements. They are computed from the
// boxes alone, in double, with every query tested against every node. For small trees.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sim_cuda/world.h"

namespace collidoscope {

struct BruteTree {
  struct Node {
    TreeLevels::Box box;
    int level = 0;
    std::size_t parent = 0, first_child = 0, children = 0;
    double sah_share = 0, sibling_overlap = 0, empty_space = 0;
    std::int64_t visits = 0;
  };
  std::vector<Node> nodes;                ///< in level order
  std::vector<std::int64_t> body_visits;  ///< by body id
  std::vector<int> body_level;            ///< level of the leaf, by body id

  /// Measures the current state. The world supplies the number of children of each node and the body of each
  /// leaf.
  explicit BruteTree(World& world) {
    const TreeLevels tree = world.tree().levels();
    for (int level = 0; level < static_cast<int>(tree.levels.size()); ++level)
      for (const TreeLevels::Box& box : tree.levels[static_cast<std::size_t>(level)]) {
        nodes.emplace_back().box = box;
        nodes.back().level = level;
      }
    std::vector<TreeLevels::Box> bodies(world.initial().size());
    body_level.resize(bodies.size());
    body_visits.resize(bodies.size());
    std::size_t next = 1;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const NodeReport report = world.tree().node(static_cast<std::uint32_t>(i));
      nodes[i].first_child = next;
      nodes[i].children = report.children;
      for (std::size_t k = 0; k < report.children; ++k) nodes[next++].parent = i;
      if (report.children > 0) continue;
      bodies[report.body] = nodes[i].box;
      body_level[report.body] = nodes[i].level;
    }
    double whole = 0;
    for (Node& node : nodes) {
      node.sah_share = area(node.box) * (node.children == 0 ? 2 : 1);
      whole += node.sah_share;
      double common = 0, filled = 0;
      for (std::size_t a = node.first_child; a < node.first_child + node.children; ++a) {
        filled += volume(nodes[a].box);
        for (std::size_t b = a + 1; b < node.first_child + node.children; ++b)
          if (overlap(nodes[a].box, nodes[b].box)) {
            common += area(meet(nodes[a].box, nodes[b].box));
            filled -= volume(meet(nodes[a].box, nodes[b].box));
          }
      }
      if (node.children == 0) continue;
      node.sibling_overlap = area(node.box) > 0 ? common / area(node.box) : 0;
      node.empty_space = volume(node.box) > 0 ? std::clamp(1 - filled / volume(node.box), 0.0, 1.0) : 1;
    }
    for (Node& node : nodes) node.sah_share /= whole;
    // A box is tested if the query overlaps its parent's box.
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (std::size_t body = 0; body < bodies.size(); ++body)
        if (i == 0 || overlap(nodes[nodes[i].parent].box, bodies[body])) {
          ++nodes[i].visits;
          ++body_visits[body];
        }
  }

  double value(std::size_t node, NodeMetric metric) const {
    const Node& n = nodes[node];
    switch (metric) {
      case NodeMetric::level:
        return n.level;
      case NodeMetric::sah_share:
        return n.sah_share;
      case NodeMetric::sibling_overlap:
        return n.sibling_overlap;
      case NodeMetric::empty_space:
        return n.empty_space;
      case NodeMetric::visits:
        return static_cast<double>(n.visits);
    }
    return 0;
  }

 private:
  static double side(const TreeLevels::Box& box, int k) {
    return static_cast<double>(box.max[k]) - static_cast<double>(box.min[k]);
  }
  static double area(const TreeLevels::Box& box) {
    const double x = side(box, 0), y = side(box, 1), z = side(box, 2);
    return 2 * (x * y + y * z + z * x);
  }
  static double volume(const TreeLevels::Box& box) { return side(box, 0) * side(box, 1) * side(box, 2); }
  static bool overlap(const TreeLevels::Box& a, const TreeLevels::Box& b) {
    for (int k = 0; k < 3; ++k)
      if (a.min[k] > b.max[k] || b.min[k] > a.max[k]) return false;
    return true;
  }
  static TreeLevels::Box meet(const TreeLevels::Box& a, const TreeLevels::Box& b) {
    TreeLevels::Box common;
    for (int k = 0; k < 3; ++k) {
      common.min[k] = std::max(a.min[k], b.min[k]);
      common.max[k] = std::min(a.max[k], b.max[k]);
    }
    return common;
  }
};

constexpr NodeMetric every_metric[] = {NodeMetric::level, NodeMetric::sah_share, NodeMetric::sibling_overlap,
                                       NodeMetric::empty_space, NodeMetric::visits};

}  // namespace collidoscope
