// Tests the statistics of trees against values by hand and against brute force. Users compare broad phases by
// these numbers.
#include "sim_cuda/broad_phase/bvh_statistics.h"
#include "sim_cuda/scene/broad_phase_methods.h"

#include <algorithm>
#include <cmath>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class QualityOfTrees : public OnEachExecutor {
 protected:
  World world_of(const Scene& scene, const std::string& method = "bvh_bottom_up") {
    RunOptions o = options();
    o.broad_phase = method;
    return World(scene, o);
  }
};
ON_EACH_EXECUTOR(QualityOfTrees);

double area(double x, double y, double z) { return 2 * (x * y + y * z + z * x); }

// Two spheres of 1 m, 3 m apart: boxes of 2 x 2 x 2 in one of 5 x 2 x 2.
TEST_P(QualityOfTrees, OfTwoBodiesByHand) {
  Scene scene = empty_space();
  scene.bodies = {sphere(1, {0, 0, 0}), sphere(1, {3, 0, 0})};
  World world = world_of(scene);
  const TreeQuality q = world.tree().quality();
  EXPECT_EQ(q.nodes, 3);
  EXPECT_EQ(q.levels, 2);
  EXPECT_EQ(q.leaves, (std::vector<std::int64_t>{0, 2}));
  const double root = area(5, 2, 2), leaf = area(2, 2, 2);
  EXPECT_NEAR(q.sah, (root + 2 * 2 * leaf) / root, 1e-6);
  EXPECT_NEAR(q.epo, 0, 1e-12) << "no body lies in a node that does not hold it";
  EXPECT_NEAR(q.sibling_overlap, 0, 1e-12);
  EXPECT_NEAR(q.empty_space, 1.0 / 5, 1e-6);
  EXPECT_EQ(q.pairs, 0);
  EXPECT_NEAR(q.visits_mean, 3, 1e-12) << "the root and both leaves";
  EXPECT_EQ(q.visits_max, 3);
  EXPECT_NEAR(q.warp_ratio, 1, 1e-12);
  EXPECT_NEAR(q.expected_visits, (7.0 * 4 * 4 + 2 * 4.0 * 4 * 4) / 20, 1e-5);
}

// Two spheres of 1 m, 1 m apart: half of each box lies inside the other.
TEST_P(QualityOfTrees, OfAnOverlapByHand) {
  Scene scene = empty_space();
  scene.bodies = {sphere(1, {0, 0, 0}), sphere(1, {1, 0, 0})};
  World world = world_of(scene);
  const TreeQuality q = world.tree().quality();
  const double root = area(3, 2, 2), leaf = area(2, 2, 2), common = area(1, 2, 2);
  EXPECT_EQ(q.pairs, 1);
  EXPECT_NEAR(q.sibling_overlap, common / root, 1e-6);
  EXPECT_NEAR(q.empty_space, 0, 1e-6);
  // One face across the axis lies inside the other box, and half of each of the four faces along the axis.
  EXPECT_NEAR(q.epo, 2 * 2 * (4 + 4 * 2) / (2 * leaf), 1e-6)
      << "each in the other's leaf, whose cost counts twice";
  EXPECT_NEAR(q.tests_per_pair, 3, 1e-12);
}

TEST_P(QualityOfTrees, VisitsAreThoseOfABruteForceWalk) {
  for (const std::string& method : broad_phase_names(GetParam())) {
    World world = world_of(box_collider(500), method);
    if (world.tree().nodes() == 0) continue;
    const TreeQuality q = world.tree().quality();
    EXPECT_EQ(q.pairs, world.measure().pairs) << method;
    EXPECT_EQ(q.bodies, 500);
    std::int64_t leaves = 0;
    for (const std::int64_t of_level : q.leaves) leaves += of_level;
    EXPECT_EQ(leaves, 500) << method;
    // The sum of visits over bodies equals the sum over nodes.
    double by_node = 0;
    const auto nodes = world.tree().ranked(NodeMetric::visits, 0, world.tree().nodes());
    ASSERT_EQ(std::ssize(nodes), world.tree().nodes());
    EXPECT_EQ(nodes.front().visits, 500) << "all queries begin at the root: " << method;
    for (const NodeReport& node : nodes) by_node += static_cast<double>(node.visits);
    EXPECT_NEAR(by_node / 500, q.visits_mean, 1e-9) << method;
    double shares = 0;
    for (const NodeReport& node : nodes) shares += node.sah_share;
    EXPECT_NEAR(shares, 1, 1e-4) << method;
    const std::vector<std::uint32_t> visited = world.tree().visited(123, 100000);
    EXPECT_LE(std::ssize(visited), q.visits_max);
    EXPECT_EQ(visited.front(), 0u);
    EXPECT_EQ(std::count_if(visited.begin(), visited.end(),
                            [&](std::uint32_t node) {
                              const NodeReport report = world.tree().node(node);
                              return report.children == 0 && report.body == 123;
                            }),
              1)
        << method;
  }
}

/// Visit counts by the definition of each traversal, computed from the reported nodes.
struct OwnTraversals {
  struct Node {
    NodeReport report;
    std::uint32_t parent = 0, first = 0, last = 0;  ///< first and last leaf place below the node
  };
  std::vector<Node> nodes;
  std::vector<std::uint32_t> leaf;  ///< node number, by leaf place

  explicit OwnTraversals(World& world) {
    std::vector<std::uint32_t> places(static_cast<std::size_t>(world.tree().nodes()));
    for (std::size_t k = 0; k < places.size(); ++k) places[k] = static_cast<std::uint32_t>(k);
    world.tree().quality();
    for (const NodeReport& report : world.tree().nodes_at(places)) nodes.push_back({report});
    number(0);
  }
  void number(std::uint32_t at) {
    const NodeReport& report = nodes[at].report;
    nodes[at].first = static_cast<std::uint32_t>(leaf.size());
    if (report.children == 0) leaf.push_back(at);
    for (std::uint32_t k = 0; k < report.children; ++k) {
      nodes[report.first_child + k].parent = at;
      number(report.first_child + k);
    }
    nodes[at].last = static_cast<std::uint32_t>(leaf.size()) - 1;
  }
  bool meet(std::uint32_t a, std::uint32_t b) const {
    const NodeReport &x = nodes[a].report, &y = nodes[b].report;
    for (int k = 0; k < 3; ++k)
      if (x.min[k] > y.max[k] || y.min[k] > x.max[k]) return false;
    return true;
  }
  /// The mean number of nodes with counts(node, place): whether the query of the leaf at `place` reads the
  /// node. The query overlaps the node's parent.
  template <class Counts>
  double mean(const Counts& counts) const {
    double all = 0;
    for (std::uint32_t place = 0; place < leaf.size(); ++place)
      for (std::uint32_t at = 1; at < nodes.size(); ++at)
        all += meet(nodes[at].parent, leaf[place]) && counts(nodes[at], place);
    return all / static_cast<double>(leaf.size());
  }
};

TEST_P(QualityOfTrees, OwnVisitsAreThoseOfTheMethodsTraversal) {
  const auto own = [&](const std::string& method, World& world) {
    const OwnVisits& visits = world.tree().quality().own;
    EXPECT_TRUE(visits.by_query) << method;
    EXPECT_EQ(world.tree().own_visits(), visits.mean) << method;
    EXPECT_LE(visits.p99, static_cast<double>(visits.max)) << method;
    EXPECT_GE(visits.warp_ratio, 1) << method;
    EXPECT_LT(visits.mean, world.tree().quality().visits_mean) << "half of a query: " << method;
    return visits.mean;
  };
  for (const char* method : {"lbvh_ropes", "refit", "ploc"}) {
    World world = world_of(box_collider(400), method);
    const OwnTraversals brute(world);
    EXPECT_NEAR(own(method, world), brute.mean([](const auto& node, std::uint32_t place) {
      return node.first > place;  // rope traversal: nodes entirely to the right
    }),
                1e-9)
        << method;
  }
  for (const char* method : {"bvh_bottom_up", "bvh_input_order", "bvh_recursive"}) {
    World world = world_of(box_collider(512), method);
    const OwnTraversals brute(world);
    EXPECT_NEAR(own(method, world), brute.mean([](const auto& node, std::uint32_t place) {
      return node.last > place;  // from the root: nodes that end to the right
    }),
                1e-9)
        << method;
  }
  World world = world_of(box_collider(400), "lbvh_top_down");
  const OwnTraversals brute(world);
  EXPECT_NEAR(own("lbvh_top_down", world), brute.mean([&](const auto& node, std::uint32_t place) {
    return node.parent == 0 || brute.nodes[node.parent].last > place;  // both children are read
  }),
              1e-9);
}

TEST_P(QualityOfTrees, WholeQueriesReadAllThatOverlapsAndFindTheSamePairs) {
  for (const char* method : {"bvh_bottom_up", "bvh_recursive", "lbvh_top_down"}) {
    RunOptions o = options();
    o.broad_phase = method;
    World half(box_collider(400), o);
    o.whole_queries = true;
    World whole(box_collider(400), o);
    const OwnTraversals brute(whole);
    EXPECT_NEAR(whole.tree().own_visits(), brute.mean([](const auto&, std::uint32_t) { return true; }), 1e-9)
        << method;
    EXPECT_GT(whole.tree().own_visits(), half.tree().own_visits()) << method;
    half.detect();
    whole.detect();
    EXPECT_EQ(whole.pairs(), half.pairs()) << method;
  }
}

// A BSP plane has no box, and Bullet's tree is deeper than the drawn one. Both are counted during the
// traversal.
TEST_P(QualityOfTrees, OwnVisitsOfPlanesAndOfADeepTree) {
  Scene apart = empty_space();  // on a line: each plane separates them without overlap
  for (int i = 0; i < 64; ++i) apart.bodies.push_back(sphere(0.25, Vector3d(i, 0, 0)));
  for (const char* method : {"bsp", "kd_tree"}) {
    World world = world_of(apart, method);
    // The query at place p reads its inner ancestors whose range extends to the right of p. Their number is
    // the number of levels above the lowest zero bit of p. The sibling of an even place is not reached.
    double all = 0;
    for (int place = 0; place < 63; ++place)
      for (int level = 0; level < 6; ++level) all += (place | ((1 << (6 - level)) - 1)) != place;
    EXPECT_NEAR(world.tree().own_visits(), all / 64, 1e-9) << method;
  }
  if (GetParam() == ExecutorKind::cuda) return;
  constexpr int n = 300;
  Scene coincident = empty_space();
  for (int i = 0; i < n; ++i) coincident.bodies.push_back(sphere(1, Vector3d(0, 0, 0)));
  World world = world_of(coincident, "bullet_dbvt");
  EXPECT_FALSE(world.tree().quality().own.by_query);
  EXPECT_GE(world.tree().own_visits(), (n - 1) / 2.0) << "each pair of leaves is tested";
  EXPECT_EQ(world.tree().own_visits(), world.tree().quality().own.mean);
}

TEST_P(QualityOfTrees, RanksNodesWorstFirst) {
  World world = world_of(box_collider(300));
  for (const NodeMetric metric :
       {NodeMetric::sah_share, NodeMetric::sibling_overlap, NodeMetric::empty_space}) {
    const auto value = [&](const NodeReport& n) {
      return metric == NodeMetric::sah_share         ? n.sah_share
             : metric == NodeMetric::sibling_overlap ? n.sibling_overlap
                                                     : n.empty_space;
    };
    const auto all = world.tree().ranked(metric, 0, 1000000);
    ASSERT_EQ(std::ssize(all), world.tree().nodes());
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end(),
                               [&](const auto& a, const auto& b) { return value(a) > value(b); }));
    const auto few = world.tree().ranked(metric, 3, 2);
    ASSERT_EQ(few.size(), 2u);
    EXPECT_EQ(few[0].node, all[3].node);
    EXPECT_EQ(few[1].node, all[4].node);
  }
}

TEST_P(QualityOfTrees, OfNothingIsZero) {
  World world = world_of(empty_space());
  EXPECT_EQ(world.tree().quality().nodes, 0);
  EXPECT_TRUE(world.tree().ranked(NodeMetric::visits, 0, 10).empty());
  World flat = world_of(box_collider(10), "brute_force");
  EXPECT_EQ(flat.tree().quality().nodes, 0);
}

TEST_P(QualityOfTrees, TimesEveryRepeat) {
  World world = world_of(box_collider(200), "lbvh_ropes");
  const std::uint64_t hash = world.state_hash();
  const BroadPhaseTimes times = world.tree().time_broad_phase(7);
  EXPECT_EQ(times.whole.size(), 7u);
  ASSERT_FALSE(times.stages.empty());
  for (const auto& stage : times.stages) EXPECT_EQ(stage.ms.size(), 7u) << stage.name;
  EXPECT_EQ(world.state_hash(), hash);
}

}  // namespace
}  // namespace collidoscope
