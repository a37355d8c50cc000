// Tests the packed instances of tree boxes and bodies against a brute-force tree.

#include "sim_cuda/publish/pack.h"
#include "sim_cuda/run/published_records.h"
#include "sim_cuda/scene/broad_phase_methods.h"

#include "tests/brute_tree.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class PackedTree : public OnEachExecutor {
 protected:
  World world_of(const std::string& method, std::int64_t bodies = 150) {
    RunOptions o = options();
    o.broad_phase = method;
    World world(box_collider(bodies), o);
    world.step(5);
    return world;
  }
  std::vector<std::string> methods_with_trees() {
    std::vector<std::string> methods;
    for (const std::string& name : broad_phase_names(GetParam()))
      if (world_of(name, 10).tree().nodes() > 0) methods.push_back(name);
    return methods;
  }
  static std::vector<BoxInstance> boxes(World& world, NodeMetric metric, int first, int last) {
    FrameLayers layers;
    layers.boxes = true;
    layers.first_level = first;
    layers.last_level = last;
    layers.box_color = metric;
    PublishedRecords records;
    world.publisher().copy(layers, records);
    return records.copy<BoxInstance>();
  }
  static std::vector<BodyInstance> bodies(World& world, BodyColor color) {
    FrameLayers layers;
    layers.spheres = true;
    layers.color = color;
    PublishedRecords records;
    world.publisher().copy(layers, records);
    return records.copy<BodyInstance>();
  }
};
ON_EACH_EXECUTOR(PackedTree);

TEST_P(PackedTree, BodiesCarryTheErrorsThatSomebodyKnows) {
  World world(box_collider(40), options());
  for (const BodyInstance& body : bodies(world, BodyColor::error)) EXPECT_EQ(body.value, 0);
  std::vector<float> errors;
  for (int k = 0; k < 40; ++k) errors.push_back(0.25f * static_cast<float>(k));
  world.publisher().set_errors(errors);
  std::vector<float> values;
  for (const BodyInstance& body : bodies(world, BodyColor::error)) values.push_back(body.value);
  EXPECT_EQ(values, errors);
  world.publisher().set_errors({1, 2});  // for another set of bodies
  for (const BodyInstance& body : bodies(world, BodyColor::error)) EXPECT_EQ(body.value, 0);
}

TEST_P(PackedTree, BoxesCarryTheirMetric) {
  for (const std::string& method : methods_with_trees()) {
    World world = world_of(method);
    const BruteTree brute(world);
    for (const NodeMetric metric : every_metric)
      for (const auto& [first, last] : {std::pair{0, 63}, {2, 5}}) {
        const std::vector<BoxInstance> packed = boxes(world, metric, first, last);
        std::size_t at = 0;
        for (std::size_t i = 0; i < brute.nodes.size(); ++i) {
          const BruteTree::Node& node = brute.nodes[i];
          if (node.level < first || node.level > last) continue;
          ASSERT_LT(at, packed.size());
          const bool has = node.children > 0 || has_leaf_values(metric);
          const double expected = has ? brute.value(i, metric) : -1;
          ASSERT_NEAR(packed[at].value, expected, 1e-5 * std::max(1e-3, std::abs(expected))) << method << i;
          ASSERT_EQ(packed[at].level, static_cast<float>(node.level));
          ++at;
        }
        EXPECT_EQ(at, packed.size());
      }
  }
}

TEST_P(PackedTree, BodiesCarryTheirDepthAndVisits) {
  for (const std::string& method : methods_with_trees()) {
    World world = world_of(method);
    const BruteTree brute(world);
    const std::vector<BodyInstance> by_depth = bodies(world, BodyColor::depth),
                                    by_visits = bodies(world, BodyColor::visits);
    for (std::size_t id = 0; id < by_depth.size(); ++id) {
      EXPECT_EQ(by_depth[id].value, static_cast<float>(brute.body_level[id])) << method << id;
      EXPECT_EQ(by_visits[id].value, static_cast<float>(brute.body_visits[id])) << method << id;
    }
    const TreeQuality& quality = world.tree().quality();
    EXPECT_EQ(quality.visits_min, *std::ranges::min_element(brute.body_visits));
    EXPECT_EQ(quality.visits_max, *std::ranges::max_element(brute.body_visits));
    std::vector<std::int64_t> leaves(world.tree().levels().levels.size());
    for (const int level : brute.body_level) ++leaves[static_cast<std::size_t>(level)];
    EXPECT_EQ(world.tree().leaves(), leaves) << method;
  }
}

TEST_P(PackedTree, WithoutATreeNothingIsPacked) {
  World world = world_of("brute_force");
  for (const BodyColor color : {BodyColor::depth, BodyColor::visits, BodyColor::order})
    for (const BodyInstance& body : bodies(world, color)) EXPECT_EQ(body.value, 0);
  EXPECT_TRUE(boxes(world, NodeMetric::visits, 0, 63).empty());
  EXPECT_EQ(world.tree().node_histogram(NodeMetric::visits, {}).count, 0);
  EXPECT_TRUE(world.tree().leaves().empty());
}

TEST_P(PackedTree, LookingAtTheTreeChangesNoState) {
  World plain = world_of("lbvh_ropes"), watched = world_of("lbvh_ropes");
  for (int k = 0; k < 5; ++k) {
    plain.step();
    watched.step();
    boxes(watched, NodeMetric::sibling_overlap, 0, 63);
    bodies(watched, BodyColor::visits);
  }
  EXPECT_EQ(watched.state_hash(), plain.state_hash());
}

TEST_P(PackedTree, TheSpreadCountsEveryNodeOnce) {
  for (const std::string& method : methods_with_trees()) {
    World world = world_of(method);
    const BruteTree brute(world);
    for (const NodeMetric metric : every_metric) {
      NodeSelection selection;
      selection.first_level = 1;
      selection.last_level = 6;
      std::vector<double> values;
      for (std::size_t i = 0; i < brute.nodes.size(); ++i)
        if (brute.nodes[i].level >= 1 && brute.nodes[i].level <= 6 &&
            (brute.nodes[i].children > 0 || has_leaf_values(metric)))
          values.push_back(brute.value(i, metric));
      std::ranges::sort(values);
      // The boundary is between two distinct values, so rounding cannot decide.
      const std::size_t third = values.size() / 3;
      std::size_t from = third;
      while (from + 1 < values.size() && values[from + 1] - values[from] <= 1e-4 * values[from + 1]) ++from;
      ASSERT_LT(from + 1, values.size());
      selection.low = static_cast<float>((values[from] + values[from + 1]) / 2);
      const NodeHistogram spread = world.tree().node_histogram(metric, selection);
      EXPECT_EQ(spread.count, std::ssize(values)) << method;
      EXPECT_EQ(spread.inside, std::ssize(values) - static_cast<std::int64_t>(from) - 1) << method;
      EXPECT_NEAR(spread.least, values.front(), 1e-5 * values.front());
      EXPECT_NEAR(spread.greatest, values.back(), 1e-5 * values.back());
      EXPECT_TRUE(std::ranges::is_sorted(spread.edge));
      std::int64_t in_bins = 0;
      for (const std::int64_t nodes : spread.nodes) in_bins += nodes;
      EXPECT_EQ(in_bins, spread.count) << method;
      EXPECT_GT(spread.nodes.front(), 0);
      EXPECT_GT(spread.nodes.back(), 0);
    }
  }
}

// The reported worst node is the worst of the whole tree, whatever levels are requested. The method builds a
// bad tree.
TEST_P(PackedTree, TheWorstNodeNamedIsTheWorst) {
  World world = world_of("bvh_input_order", 300);
  const BruteTree brute(world);
  for (const NodeMetric metric : every_metric)
    for (const auto& [first, last] : {std::pair{0, 63}, {1, 3}, {4, 4}}) {
      double worst = -1;
      for (std::size_t i = 0; i < brute.nodes.size(); ++i)
        if (brute.nodes[i].level >= first && brute.nodes[i].level <= last)
          worst = std::max(worst, brute.value(i, metric));
      const std::vector<NodeReport> named = world.tree().ranked(metric, 0, 1, first, last);
      ASSERT_EQ(named.size(), 1u);
      const BruteTree::Node& node = brute.nodes[named[0].node];
      EXPECT_NEAR(brute.value(named[0].node, metric), worst, 1e-6 * worst);
      EXPECT_TRUE(node.level >= first && node.level <= last);
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(named[0].min[k], node.box.min[k]);
        EXPECT_EQ(named[0].max[k], node.box.max[k]);
      }
      EXPECT_EQ(named[0].children, node.children);
      EXPECT_EQ(named[0].visits, node.visits);
      EXPECT_NEAR(named[0].sibling_overlap, node.sibling_overlap, 1e-6);
      EXPECT_NEAR(named[0].empty_space, node.empty_space, 1e-6);
    }
}

}  // namespace
}  // namespace collidoscope
