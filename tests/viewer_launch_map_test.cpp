// Tests the launch map panel in the window, with real events.

#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

TEST_F(Viewer, MeasuresLaunchShapesAndAppliesTheOneThatIsClicked) {
  WindowDriver window({"box_collider", "--bodies", "300", "--size", "1280x1000"});
  window.click("panel.timing");  // folded, to make room
  ASSERT_TRUE(window.wait_for([](const Json& f) {
    return f["widgets"]["panel.launch_map"][1] < f["widgets"]["panel.timing"][1].get<double>() + 40;
  }));
  window.click("panel.launch_map");
  window.type_into("launch_map.budget", "2");
  window.click("launch_map.measure");
  const auto chosen = [](const Json& f) {
    return f["launch_map"].is_object() && f["launch_map"]["done"] == true && f["playing"] == true;
  };
  ASSERT_TRUE(window.wait_for(chosen, 60)) << window.frame()["launch_map"];
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return !f["state_hash"].is_null(); }));
  const Json map = window.frame()["launch_map"];
  EXPECT_EQ(map["budget"], 2);
  EXPECT_LT(map["spent"], 4);
  EXPECT_EQ(map["now"], Json::array({0, 0})) << "auto";
  EXPECT_EQ(map["lack"], "");
  EXPECT_FALSE(map["chosen"].is_null());
  EXPECT_NE(map["verdict"], "");
  for (const Json& cell : map["cells"]) EXPECT_NE(cell["state"], 4) << "another hash: " << cell;

  const Json place = map["places"][3], shape = map["cells"][place["cell"].get<std::size_t>()]["shape"];
  const std::int64_t step = window.frame()["step"];
  window.click_at(place["at"][0].get<int>(), place["at"][1].get<int>());
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["launch_map"]["now"] == shape; })) << shape;
  EXPECT_EQ(window.frame()["blocks"], shape[0]);
  EXPECT_EQ(window.frame()["threads"], shape[1]);
  EXPECT_EQ(window.frame()["launch_map"]["done"], true) << "the map stays";
  window.move(640, 20);
  window.key("s");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] == step + 1; }));
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(step + 1, 300));

  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope
