// Tests the accuracy panel in the window, by real events. Points appear during the run, a click on a point
// applies its setting, the tolerance line selects the cheapest one, and ghosts show the errors.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

/// The place, in pixels, that is farthest from all others.
Json loneliest(const Json& places) {
  const auto distance = [](const Json& a, const Json& b) {
    return std::hypot(a["at"][0].get<double>() - b["at"][0].get<double>(),
                      a["at"][1].get<double>() - b["at"][1].get<double>());
  };
  Json best;
  double farthest = -1;
  for (const Json& place : places) {
    double nearest = 1e9;
    for (const Json& other : places)
      if (other["point"] != place["point"]) nearest = std::min(nearest, distance(place, other));
    if (!(nearest > farthest)) continue;
    farthest = nearest;
    best = place;
  }
  return best;
}

TEST_F(Viewer, MeasuresWhatAccuracyCostsAndAppliesIt) {
  WindowDriver window({"two_spheres_head_on", "--size", "1280x900"});
  const auto accuracy = [&](const char* name) { return window.frame()["accuracy"][name]; };
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] >= 3; }));
  EXPECT_TRUE(window.frame()["accuracy"].is_null()) << "folded, nothing is measured";
  window.click("panel.timing");  // folded, to make room
  window.click("panel.accuracy");
  ASSERT_TRUE(window.wait_for(
      [](const Json& f) { return f["accuracy"].is_object() && f["accuracy"]["points"].size() >= 3; }, 120));
  const int step = window.frame()["step"];
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] > step; }))
      << "the run goes on meanwhile";
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["accuracy"]["doing"] == ""; }, 240))
      << window.frame()["accuracy"].dump();
  EXPECT_EQ(accuracy("done"), 1);
  EXPECT_THAT(accuracy("reference").get<std::string>(), testing::HasSubstr("hard spheres"));

  // A click on a point applies its setting. Others may lie on top of each other.
  const Json at = loneliest(accuracy("places"));
  const std::size_t other = at["point"];
  window.click_at(at["at"][0].get<int>(), at["at"][1].get<int>());
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["accuracy"]["now"] == other; })) << other;
  EXPECT_EQ(window.frame()["edited"], true);
  EXPECT_EQ(accuracy("done"), 1) << "the study stays";

  // Dragging the line down lowers the tolerance. The button applies the cheapest setting below it.
  const double before = accuracy("tolerance");
  const Json line = accuracy("line");
  window.drag(line[0].get<int>(), line[1].get<int>(), line[0].get<int>(), line[1].get<int>() + 30);
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["accuracy"]["tolerance"] < before; }));
  ASSERT_FALSE(accuracy("cheapest").is_null());
  for (const Json& point : accuracy("points"))
    if (point["point"] == accuracy("cheapest")) {
      EXPECT_LE(point["error"], accuracy("tolerance"));
    }
  window.click("accuracy.apply");
  ASSERT_TRUE(
      window.wait_for([&](const Json& f) { return f["accuracy"]["now"] == f["accuracy"]["cheapest"]; }));

  // The study is restarted, stopped and folded.
  window.click("accuracy.restart");
  ASSERT_TRUE(
      window.wait_for([](const Json& f) { return f["accuracy"]["done"] < 1 && f["accuracy"]["since"] > 0; }));
  window.click("accuracy.running");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["accuracy"]["running"] == false; }));
  const double done = accuracy("done");
  for (int k = 0; k < 5; ++k) window.next_frame();
  EXPECT_EQ(accuracy("done"), done);
  window.click("panel.accuracy");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["accuracy"].is_null(); }));
  EXPECT_EQ(close(window), "");
}

TEST_F(Viewer, ShowsGhostsOfWhereTheBodiesShouldBe) {
  WindowDriver window({"gas", "--steps", "3", "--size", "1280x900"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false && f["step"] == 3; }));
  EXPECT_EQ(window.frame()["reference"]["name"], "");
  window.click("layers.ghosts");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["reference"]["name"] != ""; }));
  EXPECT_EQ(window.frame()["reference"]["since"], 3);
  window.move(640, 300);
  for (int k = 0; k < 12; ++k) window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 15; })) << "each step waits for it";
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["reference"]["rms"] > 0; }));
  EXPECT_EQ(window.frame()["reference"]["lack"], "");
  const Image without = picture(window);
  window.click("layers.errors");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["layers"]["errors"] == true; }));
  window.move(640, 300);
  EXPECT_GT(difference(picture(window), without, window.frame()), 1e-4);
  EXPECT_GE(window.frame()["layers"]["error_scale"], 1);
  window.click("layers.error_scale");
  window.click("layers.error_scale.1000");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["layers"]["error_scale"] == 1000; }));
  window.click("layers.reference");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["reference"]["since"] == 15; }));
  EXPECT_EQ(window.frame()["reference"]["rms"], 0);
  window.click("layers.ghosts");
  window.click("layers.errors");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["reference"]["name"] == ""; }));
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope
