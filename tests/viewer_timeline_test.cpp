// Tests the timeline of the window, by real mouse and key events: states are reached again with the same hash
// and the same picture.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

class ViewerTimeline : public Viewer {};

TEST_F(ViewerTimeline, GoesBackAndForthByHand) {
  WindowDriver window({"box_collider", "--bodies", "300", "--steps", "120", "--size", "1280x720",
                       "--executor", "cpu", "--reset-ui"});
  const auto at = [&](std::int64_t state) {
    return window.wait_for([&](const Json& f) { return f["step"] == state && f["playing"] == false; });
  };
  // Without a tooltip.
  const auto still = [&] {
    window.move(640, 12);
    return picture(window);
  };
  ASSERT_TRUE(at(120));
  EXPECT_EQ(window.frame()["timeline"], Json({0, 120}));
  window.next_frame();
  const std::string last_hash = window.frame()["state_hash"];
  EXPECT_EQ(last_hash, expected_hash(120, 300));
  const Image last = still();

  // Step back, by button and key; each state has the hash of a run that reached it at once.
  window.click("run.back");
  ASSERT_TRUE(at(119));
  window.key("shift+s");
  ASSERT_TRUE(at(118));
  window.next_frame();
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(118, 300));
  EXPECT_EQ(window.frame()["timeline"], Json({0, 120}));
  window.click("run.forward");
  window.key("s");
  ASSERT_TRUE(at(120));
  window.next_frame();
  EXPECT_EQ(window.frame()["state_hash"], last_hash);
  EXPECT_LT(difference(last, still(), window.frame()), 0.0005);

  // Drag to the start and to the middle.
  const Json slider = window.frame()["widgets"]["run.timeline"];
  const int x = slider[0].get<int>(), y = slider[1].get<int>() + slider[3].get<int>() / 2,
            w = slider[2].get<int>();
  window.drag(x + w - 6, y, x + 2, y);
  ASSERT_TRUE(at(0));
  window.next_frame();
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(0, 300));
  EXPECT_GT(difference(last, still(), window.frame()), 0.01);
  window.drag(x + 6, y, x + w / 2, y);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] > 40 && f["step"] < 80; }));
  window.next_frame();
  const std::int64_t middle = window.frame()["step"];
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(middle, 300));

  // A change there drops the later states; the run goes on from there.
  window.click("layers.spheres");  // no change of the state
  window.next_frame();
  EXPECT_EQ(window.frame()["timeline"], Json({0, 120}));
  window.type_into("settings.restitution", "0.1");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["timeline"] == Json({0, middle}); }));
  EXPECT_EQ(window.frame()["changes"], 1);
  for (int k = 0; k < 3; ++k) window.key("s");
  ASSERT_TRUE(at(middle + 3));
  EXPECT_EQ(window.frame()["timeline"], Json({0, middle + 3}));
  window.next_frame();
  EXPECT_NE(window.frame()["state_hash"], expected_hash(middle + 3, 300));
  EXPECT_EQ(window.frame()["error"], Json(nullptr));
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope
