// Tests the size of text, the space of the 3D view and the initial boxes, by real clicks.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

double scene_share(const Json& frame) {
  return frame["widgets"]["scene"][2].get<double>() / frame["window"][0].get<double>();
}

/// Fraction of differing pixels in the lower half of the right column, which holds names and numbers.
double column_difference(const Image& a, const Image& b, const Json& frame) {
  const Json& scene = frame["widgets"]["scene"];
  const int x0 = static_cast<int>(scene[0].get<double>() + scene[2].get<double>());
  int pixels = 0, changed = 0;
  for (int y = 0; y < a.height - 40; ++y)
    for (int x = x0; x < a.width; ++x, ++pixels) {
      const std::size_t at =
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(a.width) + static_cast<std::size_t>(x));
      changed += std::abs(a.rgba[at] - b.rgba[at]) + std::abs(a.rgba[at + 1] - b.rgba[at + 1]) > 24;
    }
  return static_cast<double>(changed) / pixels;
}

class ViewerLayout : public Viewer, public testing::WithParamInterface<const char*> {};

TEST_P(ViewerLayout, TextGrowsUnderThePointerAndLeavesThePicture) {
  WindowDriver window({"box_collider", "--bodies", "200", "--size", GetParam()});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] >= 4; }));
  const int middle = window.place("scene").first;
  window.click_at(middle, 20);  // no body is there: a selected one would scroll the column
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
  window.key("Escape");
  window.move(middle, 20);
  const Image before = picture(window);
  EXPECT_GE(scene_share(window.frame()), 0.4);

  // The pointer stays at the initial position of A+.
  const auto [x, y] = window.place("view.larger");
  const double first = window.frame()["font_scale"];
  int grown = 0;
  for (int k = 0; k < 10; ++k) {
    const double scale = window.frame()["font_scale"];
    if (!window.sees("view.larger")) break;  // grey at the largest size that fits
    const Json rect = window.frame()["widgets"]["view.larger"];
    EXPECT_TRUE(rect[0] <= x && x <= rect[0].get<double>() + rect[2].get<double>() && rect[1] <= y &&
                y <= rect[1].get<double>() + rect[3].get<double>())
        << k << ' ' << rect;
    window.click_at(x, y);
    window.next_frame();
    grown += window.frame()["font_scale"] > scale;
    EXPECT_GE(scene_share(window.frame()), 0.4) << k;
  }
  EXPECT_GE(grown, 2);
  EXPECT_GT(window.frame()["font_scale"], 1.2 * first);
  // Smaller than at first and back: the tables look the same.
  for (int k = 0; k < 6 && window.sees("view.smaller"); ++k) {
    window.click("view.smaller");
    EXPECT_GE(scene_share(window.frame()), 0.4) << k;
  }
  EXPECT_LT(window.frame()["font_scale"], first);
  window.move(middle, 20);
  window.key("ctrl+0");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["font_scale"] == first; }));
  window.next_frame();
  EXPECT_LT(column_difference(before, picture(window), window.frame()), 0.003);
  EXPECT_EQ(close(window), "");
}

INSTANTIATE_TEST_SUITE_P(Sizes, ViewerLayout, testing::Values("1280x720", "1440x900", "1920x1080"),
                         [](const auto& size) { return "Of" + std::string(size.param); });

TEST_F(Viewer, BoxesBeginWithAFewLevels) {
  WindowDriver window({"box_collider", "--bodies", "2000", "--size", "1280x900"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] >= 2; }));
  window.move(640, 300);
  window.key("space");
  window.click("layers.boxes");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["drawn"]["boxes"] > 0; }));
  EXPECT_EQ(window.frame()["layers"]["first_level"], 2);
  EXPECT_EQ(window.frame()["layers"]["last_level"], 4);
  EXPECT_EQ(window.frame()["drawn"]["boxes"], 4 + 8 + 16);

  // The level under the pointer is highlighted in the picture.
  const Json bar = window.frame()["widgets"]["layers.levels"];
  const auto cell = [&](int level) {
    return static_cast<int>(bar[0].get<double>() + (level + 0.5) * bar[2].get<double>() / 16);
  };
  const int y = bar[1].get<int>() + bar[3].get<int>() / 2;
  window.move(640, 20);
  const Image all = picture(window);
  window.move(cell(3), y);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["hovered_level"] >= 0; }));
  EXPECT_GT(difference(all, picture(window), window.frame()), 0.002);
  window.move(640, 20);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["hovered_level"] == -1; }));

  // The chosen levels are kept.
  window.drag(cell(4), y, cell(6), y);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["layers"]["last_level"] > 4; }));
  const int last = window.frame()["layers"]["last_level"];
  for (const bool on : {false, true}) {
    window.click("layers.boxes");
    ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["layers"]["boxes"] == on; }));
  }
  EXPECT_EQ(window.frame()["layers"]["last_level"], last);
  EXPECT_EQ(close(window), "");
}

TEST_F(Viewer, AStageStaysHighlighted) {
  WindowDriver window({"box_collider", "--bodies", "300", "--size", "1280x900"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] >= 30; }));
  window.move(640, 300);
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
  const Image plain = picture(window);
  window.click("timing.solve");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["chosen_stage"] >= 0; }));
  window.move(640, 300);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["notice"] == ""; }));
  const Image chosen = picture(window);
  // The graph dims the other stages even if the pointer is elsewhere.
  const Json rect = window.frame()["widgets"]["graph.stages"];
  int changed = 0;
  for (int y = rect[1].get<int>() + 25; y < rect[1].get<int>() + rect[3].get<int>(); ++y)
    for (int x = rect[0].get<int>(); x < rect[0].get<int>() + rect[2].get<int>(); ++x) {
      const std::size_t at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(plain.width) +
                                  static_cast<std::size_t>(x));
      changed += std::abs(plain.rgba[at] - chosen.rgba[at]) > 24;
    }
  EXPECT_GT(changed, 300);
  window.click("timing.solve");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["chosen_stage"] == -1; }));
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope
