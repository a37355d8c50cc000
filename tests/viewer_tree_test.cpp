// Tests the tree panel in the window, by real mouse and key events.

#include <gtest/gtest.h>

#include "tests/viewer_fixture.h"
#include "ui/tree_panel_view.h"

namespace collidoscope {
namespace {

class ViewerTree : public Viewer {
 protected:
  static constexpr int bodies = 300, state = 20;

  /// The same state with the same tree, computed in this process.
  static World same_world() {
    Scene scene = read_scene(asset("scenes/box_collider.json").string());
    scene.generators[0].count = bodies;
    RunOptions options;
    options.executor = ExecutorKind::cpu;
    options.broad_phase = "bvh_input_order";
    World world(scene, options);
    world.step(state);
    return world;
  }
  /// A picture without a tooltip.
  static Image still(WindowDriver& window) {
    window.move(640, 12);
    return picture(window);
  }
  static void choose(WindowDriver& window, const std::string& list, const std::string& choice) {
    window.click(list);
    ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["widgets"].contains(list + "." + choice); }))
        << choice;
    window.click(list + "." + choice);
  }
  static std::vector<std::uint32_t> places(const Json& rows) {
    std::vector<std::uint32_t> list;
    for (const Json& row : rows) list.push_back(row["node"]);
    return list;
  }
  static std::vector<std::uint32_t> places(const std::vector<NodeReport>& nodes) {
    std::vector<std::uint32_t> list;
    for (const NodeReport& node : nodes) list.push_back(node.node);
    return list;
  }
};

TEST_F(ViewerTree, ThePanelIsOperatedByHand) {
  WindowDriver window({"box_collider", "--bodies", std::to_string(bodies), "--steps", std::to_string(state),
                       "--size", "1280x900", "--executor", "cpu", "--reset-ui"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == state && f["playing"] == false; }));
  EXPECT_TRUE(window.frame()["tree"].is_null()) << "folded, it costs nothing";
  const auto tree = [&](const char* name) { return window.frame()["tree"][name]; };
  const auto wait = [&](const std::function<bool(const Json&)>& so) {
    return window.wait_for([&](const Json& f) { return f["tree"].is_object() && so(f["tree"]); });
  };
  World world = same_world();

  // Unfold the panel in place of others; change the method while the run plays or pauses.
  window.click("panel.timing");
  window.click("panel.numbers");
  window.click("panel.tree");
  ASSERT_TRUE(wait([](const Json& t) { return t["step"] == state; }));
  const double good = tree("sah");
  choose(window, "tree.method", "bvh_input_order");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["broad_phase"] == "bvh_input_order"; }));
  ASSERT_TRUE(wait([&](const Json& t) { return t["sah"] > 1.5 * good; })) << "the tree is worse";
  EXPECT_NEAR(tree("sah").get<double>(), world.tree().quality().sah, 1e-9);

  // Each colour changes the picture.
  const Image without = still(window);
  window.click("tree.boxes");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["layers"]["boxes"] == true; }));
  Image before = still(window);
  EXPECT_GT(difference(without, before, window.frame()), 0.01);
  for (const auto& [name, metric] :
       {std::pair{"visits", 4}, {"empty space", 3}, {"SAH share", 1}, {"sibling overlap", 2}}) {
    choose(window, "tree.color", name);
    ASSERT_TRUE(window.wait_for([m = metric](const Json& f) { return f["layers"]["box_color"] == m; }))
        << name;
    EXPECT_EQ(tree("sort"), metric) << "the table follows";
    const Image now = still(window);
    EXPECT_GT(difference(before, now, window.frame()), 0.01) << name;
    before = now;
  }

  // Rows are sorted worst first by every column; pages and neighbours follow the order.
  EXPECT_EQ(places(tree("rows")),
            places(world.tree().ranked(NodeMetric::sibling_overlap, 0, TreePanelView::page)));
  for (const auto& [column, metric] : {std::pair{"tree.sort.empty", NodeMetric::empty_space},
                                       {"tree.sort.visits", NodeMetric::visits},
                                       {"tree.sort.overlap", NodeMetric::sibling_overlap}}) {
    window.click(column);
    ASSERT_TRUE(wait([m = metric](const Json& t) { return t["sort"] == static_cast<int>(m); })) << column;
    window.click("tree.page.next");
    ASSERT_TRUE(wait([](const Json& t) { return t["first"] == TreePanelView::page; }));
    EXPECT_EQ(places(tree("rows")),
              places(world.tree().ranked(metric, TreePanelView::page, TreePanelView::page)));
    window.click("tree.page.previous");
    ASSERT_TRUE(wait([](const Json& t) { return t["first"] == 0; }));
    EXPECT_EQ(places(tree("rows")), places(world.tree().ranked(metric, 0, TreePanelView::page)));
  }
  const std::vector<std::uint32_t> order = places(world.tree().ranked(NodeMetric::sibling_overlap, 0, 20));
  before = still(window);
  window.click("tree.row.7");
  ASSERT_TRUE(wait([&](const Json& t) { return t["node"] == order[7]; }));
  EXPECT_GT(difference(before, still(window), window.frame()), 0.002) << "it is marked";
  for (const std::size_t rank : {8u, 9u, 10u}) {
    window.click("tree.next");
    ASSERT_TRUE(wait([&](const Json& t) { return t["node"] == order[rank]; })) << rank;
  }
  EXPECT_EQ(tree("first"), TreePanelView::page) << "the page follows";
  window.click("tree.previous");
  ASSERT_TRUE(wait([&](const Json& t) { return t["node"] == order[9]; }));
  const auto distance = [&] { return window.frame()["camera"][5].get<double>(); };
  const double far = distance();
  window.click("tree.frame");
  window.next_frame();
  EXPECT_NE(distance(), far) << "the camera goes there";
  window.key("shift+f");

  // A range: dragged from below, then reset.
  const std::int64_t all = tree("inside");
  EXPECT_GT(all, bodies - 10) << "the inner nodes";
  before = still(window);
  const Json spread = window.frame()["widgets"]["tree.spread"];
  const int x = spread[0].get<int>(), y = spread[1].get<int>() + spread[3].get<int>() / 2,
            w = spread[2].get<int>();
  window.drag(x + 1, y, x + w / 2, y);
  ASSERT_TRUE(wait([&](const Json& t) { return t["range"][0] > 0 && t["inside"] < all; }));
  const double low = tree("range")[0];
  NodeSelection selection;
  selection.low = static_cast<float>(low);
  EXPECT_EQ(tree("inside"), world.tree().node_histogram(NodeMetric::sibling_overlap, selection).inside);
  EXPECT_GT(difference(before, still(window), window.frame()), 0.005);
  window.click("tree.auto");
  ASSERT_TRUE(wait([&](const Json& t) { return t["range"][0] == 0 && t["inside"] == all; }));

  // Levels, by the same bar as in the layers panel; the table shows these levels.
  const Json levels = window.frame()["widgets"]["tree.levels"];
  window.drag(levels[0].get<int>() + 2, levels[1].get<int>() + 5,
              levels[0].get<int>() + levels[2].get<int>() / 2, levels[1].get<int>() + 5);
  ASSERT_TRUE(wait([](const Json& t) { return t["ranked"] < t["nodes"].get<int>() - 10; }));
  window.next_frame();
  const int first = window.frame()["layers"]["first_level"];
  EXPECT_EQ(places(tree("rows"))[0],
            world.tree().ranked(NodeMetric::sibling_overlap, 0, 1, first).front().node);

  // A leaf selects its body and shows its query step by step.
  window.click("tree.sort.lvl");
  ASSERT_TRUE(wait([](const Json& t) { return t["sort"] == 0; }));
  window.click("tree.row.0");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["selection"].is_number(); }));
  EXPECT_TRUE(tree("node").is_null());
  const auto body = window.frame()["selection"].get<std::uint32_t>();
  EXPECT_EQ(body, world.tree().ranked(NodeMetric::level, 0, 1).front().body);
  window.click("tree.query");
  ASSERT_TRUE(wait([&](const Json& t) { return t["visits"] == world.tree().visits_of(body); }));
  const int visits = tree("visits");
  const Image start = still(window);
  for (int k = 0; k < 3; ++k) window.click("tree.query.on");
  ASSERT_TRUE(wait([](const Json& t) { return t["visit"] == 4; }));
  EXPECT_GT(difference(start, still(window), window.frame()), 0.001);
  const Json slider = window.frame()["widgets"]["tree.query.at"];
  window.drag(slider[0].get<int>() + 8, slider[1].get<int>() + 8,
              slider[0].get<int>() + slider[2].get<int>() + 20, slider[1].get<int>() + 8);
  ASSERT_TRUE(wait([&](const Json& t) { return t["visit"] == visits; }));
  window.click("tree.query.back");
  ASSERT_TRUE(wait([&](const Json& t) { return t["visit"] == visits - 1; }));
  window.click("tree.query.on");
  window.click("tree.query.play");  // from the start
  ASSERT_TRUE(wait([&](const Json& t) { return t["visit"] > 1 && t["visit"] < visits; }));
  ASSERT_TRUE(wait([&](const Json& t) { return t["visit"] == visits; })) << "to the end";
  EXPECT_EQ(window.frame()["playing"], false) << "the run is not what plays";

  // A click on an edge in the picture selects its node.
  window.key("Escape");
  window.click("layers.spheres");
  ASSERT_TRUE(
      window.wait_for([](const Json& f) { return f["selection"].is_null() && f["drawn"]["spheres"] == 0; }));
  for (int k = 0; k < 40 && tree("node").is_null(); ++k) window.click_at(430 + 8 * k, 330);
  ASSERT_TRUE(tree("node").is_number());
  EXPECT_GE(world.tree().node(tree("node")).level, first) << "of the levels that are drawn";

  // The state is unchanged; the next one has another tree.
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(state, bodies));
  window.key("s");
  ASSERT_TRUE(wait([](const Json& t) { return t["step"] == state + 1; }));
  EXPECT_TRUE(tree("node").is_null());
  window.click("panel.tree");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["tree"].is_null(); }));
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope
