// Tests the measurements that the tree panel requests from a world: their values against a brute-force tree,
// and their number.

#include "viewer/session/tree_inspector.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "tests/brute_tree.h"
#include "tests/scenes.h"
#include "viewer/session/tree_marks.h"

namespace collidoscope {
namespace {

World world_of(const std::string& method, std::int64_t bodies = 200) {
  RunOptions options;
  options.executor = ExecutorKind::cpu;
  options.broad_phase = method;
  return World(box_collider(bodies), options);
}

/// Paused, with the tree panel open.
Workspace open_panel() {
  Workspace workspace;
  workspace.playing = false;
  workspace.visible_panels.tree = true;
  return workspace;
}

TEST(TreeInspector, AFoldedPanelCostsNothing) {
  World world = world_of("lbvh_ropes");
  world.detect();
  const std::int64_t bytes = world.info().allocated_bytes;
  Workspace workspace = open_panel();
  workspace.visible_panels.tree = false;
  TreeInspector inspector;
  inspector.refresh(world, 0, workspace);
  EXPECT_EQ(inspector.view(), nullptr);
  workspace.visible_panels.tree = true;
  workspace.visible_panels.right = false;
  inspector.refresh(world, 0, workspace);
  EXPECT_EQ(inspector.view(), nullptr);
  EXPECT_EQ(world.info().allocated_bytes, bytes) << "nothing was measured";
  workspace.visible_panels.right = true;
  inspector.refresh(world, 0, workspace);
  ASSERT_NE(inspector.view(), nullptr);
  EXPECT_GT(world.info().allocated_bytes, bytes);
}

TEST(TreeInspector, MeasuresAStateOnce) {
  World world = world_of("lbvh_ropes");
  Workspace workspace = open_panel();
  TreeInspector inspector;
  inspector.refresh(world, 0, workspace);
  const int version = inspector.version();
  inspector.refresh(world, 0, workspace);
  EXPECT_EQ(inspector.version(), version);
  world.step();
  inspector.refresh(world, 0, workspace);
  EXPECT_NE(inspector.version(), version);
  EXPECT_EQ(inspector.view()->step, 1);
}

// The method builds a bad tree. Each row and page of the panel lists the nodes worst first, as in the
// brute-force tree.
TEST(TreeInspector, NamesTheWorstFirst) {
  World world = world_of("bvh_input_order");
  const BruteTree brute(world);
  Workspace workspace = open_panel();
  TreeInspector inspector;
  for (const NodeMetric metric : {NodeMetric::sibling_overlap, NodeMetric::empty_space, NodeMetric::visits}) {
    workspace.tree.sort = metric;
    workspace.layers.first_level = 2;
    std::vector<double> values;
    for (std::size_t i = 0; i < brute.nodes.size(); ++i)
      if (brute.nodes[i].level >= 2) values.push_back(brute.value(i, metric));
    std::ranges::sort(values, std::greater<>());
    std::vector<double> named;
    for (std::int64_t first = 0; first < std::ssize(values); first += TreePanelView::page) {
      workspace.tree.first = first;
      inspector.refresh(world, 0, workspace);
      EXPECT_EQ(inspector.view()->first, first);
      for (const NodeReport& row : inspector.view()->rows) named.push_back(brute.value(row.node, metric));
    }
    ASSERT_EQ(named.size(), values.size());
    EXPECT_EQ(inspector.view()->ranked, std::ssize(values));
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(named[i], values[i], 1e-6 * values[i]) << i;
  }
}

TEST(TreeInspector, ARankSelectsANodeOrABodyUntilTheNextState) {
  World world = world_of("bvh_bottom_up");
  Workspace workspace = open_panel();
  TreeInspector inspector;
  workspace.selection = 3;
  workspace.tree.sort = NodeMetric::sibling_overlap;
  workspace.tree.rank = 20;
  inspector.refresh(world, 0, workspace);
  EXPECT_FALSE(workspace.tree.rank.has_value());
  EXPECT_FALSE(workspace.selection.has_value()) << "a node is selected in its place";
  EXPECT_EQ(workspace.tree.first, 20 / TreePanelView::page * TreePanelView::page) << "the page follows";
  ASSERT_TRUE(workspace.tree.node.has_value());
  const TreePanelView& view = *inspector.view();
  EXPECT_EQ(*workspace.tree.node, view.rows[20 % TreePanelView::page].node);
  ASSERT_TRUE(view.node.has_value());
  ASSERT_EQ(view.children.size(), view.node->children);
  const std::vector<BoxInstance> marks = tree_marks(workspace, nullptr, &view);
  ASSERT_EQ(marks.size(), 3u);
  EXPECT_EQ(marks[0].value, static_cast<float>(BoxMark::left));
  EXPECT_EQ(marks[1].value, static_cast<float>(BoxMark::right));
  EXPECT_EQ(marks[2].value, static_cast<float>(BoxMark::node));
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(marks[2].min[k], std::min(marks[0].min[k], marks[1].min[k])) << "they fill it";
    EXPECT_EQ(marks[2].max[k], std::max(marks[0].max[k], marks[1].max[k]));
  }
  // By level, the last node is the root; the first are the deepest leaves.
  workspace.tree.sort = NodeMetric::level;
  workspace.tree.rank = 0;
  inspector.refresh(world, 0, workspace);
  EXPECT_TRUE(workspace.selection.has_value());
  EXPECT_FALSE(workspace.tree.node.has_value());
  workspace.tree.rank = 1'000'000;
  inspector.refresh(world, 0, workspace);
  EXPECT_EQ(workspace.tree.node, 0u);
  world.step();
  inspector.refresh(world, 0, workspace);
  EXPECT_FALSE(workspace.tree.node.has_value()) << "of another tree";
  EXPECT_FALSE(inspector.view()->node.has_value());
}

TEST(TreeInspector, AQueryIsFollowedInItsOrder) {
  for (const char* method : {"lbvh_ropes", "bvh_input_order"}) {
    World world = world_of(method, 120);
    const BruteTree brute(world);
    Workspace workspace = open_panel();
    workspace.tree.query = true;
    workspace.selection = 17;
    TreeInspector inspector;
    inspector.refresh(world, 0, workspace);
    const TreePanelView& view = *inspector.view();
    EXPECT_EQ(view.queried, 17u);
    EXPECT_EQ(view.visits, brute.body_visits[17]);
    ASSERT_EQ(std::ssize(view.visited), view.visits);
    EXPECT_EQ(view.visited.front().node.node, 0u) << "from the root";
    std::set<std::uint32_t> met;
    std::int64_t pairs = 0;
    for (const auto& [node, overlaps] : view.visited) {
      EXPECT_TRUE(node.node == 0 || met.contains(static_cast<std::uint32_t>(brute.nodes[node.node].parent)))
          << "only below what it met, and after it";
      if (overlaps) met.insert(node.node);
      pairs += overlaps && node.children == 0 && node.body != 17;
    }
    std::int64_t expected = 0;
    for (const auto& [a, b] : world.pairs()) expected += a == 17 || b == 17;
    EXPECT_EQ(pairs, expected) << method;

    // Marks for the visits up to the slider, the newest on top with a halo.
    const BodyReport body = world.inspect(17);
    workspace.tree.visit = 5;
    const std::vector<BoxInstance> marks = tree_marks(workspace, &body, &view);
    ASSERT_EQ(marks.size(), 6u);
    EXPECT_EQ(marks[1].value, static_cast<float>(BoxMark::current));
    for (const std::size_t k : {0u, 2u, 3u, 4u, 5u}) {
      const TreePanelView::Visited& visited = view.visited[k == 0 ? 4 : 5 - k];
      EXPECT_EQ(marks[k].min[0], visited.node.min[0]);
      EXPECT_EQ(marks[k].value, static_cast<float>(visited.met ? BoxMark::met : BoxMark::apart));
    }
    workspace.tree.query = false;
    inspector.refresh(world, 0, workspace);
    EXPECT_EQ(tree_marks(workspace, &body, inspector.view()).size(), body.path.size()) << "its path again";
  }
}

TEST(TreeInspector, WhatHasNoTreeHasNoRows) {
  World world = world_of("brute_force");
  Workspace workspace = open_panel();
  workspace.layers.box_color = NodeMetric::visits;
  workspace.tree.rank = 4;
  workspace.tree.node = 7;
  workspace.tree.query = true;
  workspace.selection = 1;
  TreeInspector inspector;
  inspector.refresh(world, 0, workspace);
  ASSERT_NE(inspector.view(), nullptr);
  EXPECT_TRUE(inspector.view()->rows.empty());
  EXPECT_FALSE(workspace.tree.node.has_value());
  EXPECT_EQ(inspector.view()->visits, 0);
}

}  // namespace
}  // namespace collidoscope
