// Tests numbers typed into the window: an invalid one is reported there and changes nothing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

TEST_F(Viewer, ReportsNumbersThatItCannotUse) {
  WindowDriver window({"box_collider", "--bodies", "100", "--size", "1280x900"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] >= 1; }));
  window.click_at(640, 300);
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
  const Json before = window.frame();
  const auto refused = [&](const char* widget, const char* text, const char* report) {
    window.type_into(widget, text);
    const auto reported = [&](const Json& f) {
      return f["input_fault"].is_string() &&
             f["input_fault"].get<std::string>().find(report) != std::string::npos;
    };
    EXPECT_TRUE(window.wait_for(reported, 15))
        << widget << ' ' << text << ": " << window.frame()["input_fault"].dump();
    window.next_frame();
    for (const char* setting :
         {"bodies", "blocks", "threads", "time_step", "restitution", "seed", "substeps", "iterations"})
      EXPECT_EQ(window.frame()[setting], before[setting]) << widget << ' ' << text;
    EXPECT_TRUE(window.frame()["error"].is_null());
  };
  refused("settings.blocks", "99999999999",
          "B: 99999999999 is out of range; allowed: a whole number from 1 to 2,147,483,647, or auto");
  refused("settings.threads", "1025",
          "T: 1025 is out of range; allowed: a whole number from 1 to 1,024, or auto");
  refused("settings.bodies", "0", "N: 0 is out of range; allowed: a whole number from 1 to 134,217,728");
  refused("settings.bodies", "many", "N: 'many' is not a whole number");
  refused("settings.rate", "abc", "step rate: 'abc' is not a number; allowed: 0.001 to 1e+06 Hz");
  refused("settings.rate", "1e9", "step rate: 1e9 is out of range; allowed: 0.001 to 1e+06 Hz");
  refused("settings.restitution.value", "1.5", "restitution: 1.5 is out of range; allowed: 0 to 1");
  refused("settings.substeps", "1001",
          "substeps: 1001 is out of range; allowed: a whole number from 1 to 1,000, or auto");
  refused("settings.iterations", "0",
          "iterations: 0 is out of range; allowed: a whole number from 1 to 1,000");
  refused("settings.radius", "0", "radius: 0 is out of range; allowed: 0.001 to 50 m");
  refused("settings.radius", "60", "radius: 60 is out of range; allowed: 0.001 to 50 m");
  refused("settings.seed", "-1", "seed: -1 is out of range");

  // The report appears in red below its row until the next input.
  window.move(640, 300);
  const Image reported = picture(window);
  const Json rect = window.frame()["widgets"]["settings.seed"];
  const auto red = [&](const Image& image) {
    int pixels = 0;
    for (int y = rect[1].get<int>(); y < rect[1].get<int>() + 5 * rect[3].get<int>(); ++y)
      for (int x = 0; x < 270; ++x) {
        const std::size_t at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                    static_cast<std::size_t>(x));
        pixels += image.rgba[at] > 180 && image.rgba[at + 1] < 150 && image.rgba[at + 2] < 150;
      }
    return pixels;
  };
  EXPECT_GT(red(reported), 40);
  window.type_into("settings.rate", "60");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["time_step"] == 1.0 / 60; }));
  EXPECT_TRUE(window.frame()["input_fault"].is_null());
  window.move(640, 300);
  EXPECT_EQ(red(picture(window)), 0);

  // A click on another widget accepts the number; Escape restores the value.
  window.click("settings.seed");
  window.hands({"key", "ctrl+a"});
  window.hands({"type", "--", "77"});
  window.click("run.step");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["seed"] == 77; }));
  window.click("settings.seed");
  window.hands({"key", "ctrl+a"});
  window.hands({"type", "--", "88"});
  window.key("Escape");
  window.next_frame();
  EXPECT_EQ(window.frame()["seed"], 77);
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope
