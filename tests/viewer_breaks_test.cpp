// Tests the automatic stops of the window's run, by real events: break conditions, findings of guards, and
// the ways to continue.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/falling_scene.h"
#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

std::string write_scene_file(const TemporaryFolder& folder, const std::string& guards) {
  const std::string file = (folder / "falling.json").string();
  std::ofstream(file) << falling_scene(guards);
  return file;
}

/// Counts pixels in the colour of frozen bodies.
int pale_blue(const Image& picture) {
  int count = 0;
  for (std::size_t at = 0; at + 3 < picture.rgba.size(); at += 4)
    count += picture.rgba[at] == 120 && picture.rgba[at + 1] == 214 && picture.rgba[at + 2] == 255;
  return count;
}

TEST_F(Viewer, StopsWhereTheCommandLineSays) {
  TemporaryFolder folder;
  WindowDriver window(
      {write_scene_file(folder, ""), "--break", "escaped,speed=5.5", "--size", "1280x900", "--reset-ui"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["stop"].is_object(); }));
  EXPECT_EQ(window.frame()["step"], 5);
  EXPECT_EQ(window.frame()["selection"], 1);
  window.next_frame();
  EXPECT_TRUE(window.frame()["widgets"].contains("breaks.escaped")) << "the panel is open";
  EXPECT_EQ(close(window), "");
}

TEST_F(Viewer, StopsWhereAConditionIsMet) {
  TemporaryFolder folder;
  WindowDriver window({write_scene_file(folder, ""), "--steps", "1", "--size", "1280x900"});
  window.click("panel.timing");  // folded, to make room
  ASSERT_TRUE(window.wait_for([](const Json& f) { return !f["widgets"].contains("timing.csv"); }));
  window.next_frame();
  window.click("panel.breaks");
  window.click("breaks.speed");
  window.type_into("breaks.speed.limit", "5.5");
  EXPECT_TRUE(window.frame()["stop"].is_null());
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
  window.click("run.play");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["stop"].is_object(); }));
  EXPECT_EQ(window.frame()["playing"], false);
  EXPECT_EQ(window.frame()["step"], 5);
  EXPECT_EQ(window.frame()["selection"], 1);
  EXPECT_THAT(window.frame()["stop"]["what"].get<std::string>(), testing::HasSubstr("body 1"));

  window.next_frame();  // lets the layout include the new line
  window.click("stop.save");
  ASSERT_TRUE(window.wait_for([](const Json& f) {
    return f["last_notice"].get<std::string>().find("wrote captures/") != std::string::npos;
  }));
  EXPECT_TRUE(std::filesystem::exists(window.file("captures/before_000005.snapshot")));
  EXPECT_EQ(window.frame()["step"], 5);
  window.click("stop.go_on");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] > 8; })) << "it is not met anew";
  EXPECT_TRUE(window.frame()["stop"].is_null());
  EXPECT_EQ(close(window), "");
}

TEST_F(Viewer, PausesAtWhatAGuardFinds) {
  TemporaryFolder folder;
  WindowDriver window(
      {write_scene_file(folder, R"({"on_failure": "pause", "speed": 5.5})"), "--size", "1280x900"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["stop"].is_object(); }));
  EXPECT_EQ(window.frame()["playing"], false);
  EXPECT_EQ(window.frame()["step"], 4) << "the state before";
  EXPECT_EQ(window.frame()["selection"], 1);
  EXPECT_EQ(window.frame()["stop"]["found"], true);
  EXPECT_EQ(pale_blue(picture(window)), 0);
  window.move(640, 300);
  window.key("space");
  window.next_frame();
  EXPECT_EQ(window.frame()["playing"], false) << "the guard holds it";

  window.click("stop.freeze");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["frozen"].size() == 1; }));
  EXPECT_TRUE(window.frame()["stop"].is_null());
  EXPECT_GT(pale_blue(picture(window)), 50) << "what is frozen is marked";
  window.move(640, 300);
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["stop"].is_object(); }));
  EXPECT_EQ(window.frame()["step"], 5);
  EXPECT_EQ(window.frame()["selection"], 0);

  // Guards that are switched off in the effects panel do not pause the run.
  window.click("panel.timing");
  window.click("panel.effects");
  window.click("effects.guards");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["effects"]["guards"]["on"] == false; }));
  EXPECT_TRUE(window.frame()["stop"].is_null());
  EXPECT_EQ(window.frame()["frozen"].size(), 1u) << "nobody thaws";
  window.move(640, 300);
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] > 8; }));
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope
