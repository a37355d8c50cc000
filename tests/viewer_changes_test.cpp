// Tests changes made in the window, by real events, against their replay from a file by the headless program.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/falling_scene.h"
#include "tests/run_program.h"
#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

/// The next file of changes.
std::string written_changes(WindowDriver& window) {
  const std::string before = window.frame()["last_notice"];
  window.click("run.changes");
  EXPECT_TRUE(window.wait_for([&](const Json& f) {
    const std::string notice = f["last_notice"];
    return notice != before && notice.starts_with("wrote captures/changes_");
  }));
  return window.file(window.frame()["last_notice"].get<std::string>().substr(6));
}

/// The state hash of `collidoscope-headless run` with a changes file.
std::string replayed(const std::string& scene, const std::vector<std::string>& flags,
                     const std::string& changes) {
  std::vector<std::string> arguments{"run", scene, "--executor", "cpu", "--changes", changes, "--json", "-"};
  arguments.insert(arguments.end(), flags.begin(), flags.end());
  const Outcome outcome = run_headless(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err << text_of(changes);
  return outcome.status == 0 ? Json::parse(outcome.out)["state_hash"].get<std::string>() : "";
}

TEST_F(Viewer, WritesAFrozenBodyDown) {
  TemporaryFolder folder;
  const std::string scene = (folder / "falling.json").string();
  std::ofstream(scene) << falling_scene(R"({"on_failure": "pause", "speed": 5.5})");
  WindowDriver window({scene, "--size", "1280x900"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["stop"].is_object(); }));
  EXPECT_EQ(window.frame()["changes"], 0);
  window.next_frame();
  window.click("stop.freeze");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["frozen"].size() == 1; }));
  EXPECT_EQ(window.frame()["changes"], 1);
  EXPECT_EQ(window.frame()["edited"], true);
  window.move(640, 300);
  window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 5; }));
  const std::string hash = window.frame()["state_hash"];
  const std::string file = written_changes(window);
  EXPECT_THAT(text_of(file), testing::HasSubstr("\"freeze\": [1]"));
  EXPECT_EQ(replayed(scene, {}, file), hash);
  EXPECT_EQ(close(window), "");
}

TEST_F(Viewer, ADragIsOneChange) {
  WindowDriver window({"box_collider", "--bodies", "200", "--size", "1280x900", "--executor", "cpu"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] >= 3; }));
  const auto drag = [&](const char* widget, double from, double to) {
    const Json rect = window.frame()["widgets"][widget];
    const int y = rect[1].get<int>() + rect[3].get<int>() / 2;
    const auto x = [&](double share) {
      return static_cast<int>(rect[0].get<double>() + share * rect[2].get<double>());
    };
    window.hands({"mousemove", std::to_string(x(from)), std::to_string(y), "mousedown", "1"});
    window.next_frame();
    for (int k = 1; k <= 6; ++k) {  // wait for frames, so that steps could be made in between
      window.move(x(from + (to - from) * k / 6), y);
      window.next_frame();
    }
    window.input({"mouseup", "1"}, 1);
  };
  drag("settings.restitution", 0.8, 0.3);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["restitution"] < 0.5; }));
  EXPECT_EQ(window.frame()["changes"], 1);
  drag("settings.bodies.slider", 0.55, 0.62);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["bodies"] != 200; }));
  EXPECT_EQ(window.frame()["changes"], 2);
  drag("settings.blocks.slider", 0.1, 0.6);
  EXPECT_EQ(window.frame()["changes"], 3);
  const std::int64_t step = window.frame()["step"];
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] > step + 2; })) << "it goes on";
  window.move(640, 300);
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
  window.next_frame();
  const std::string hash = window.frame()["state_hash"];
  EXPECT_EQ(replayed("box_collider", {"--bodies", "200"}, written_changes(window)), hash);

  // At the start only the net difference remains, as one change.
  window.move(640, 300);
  window.key("r");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 0; }));
  window.next_frame();
  EXPECT_EQ(window.frame()["changes"], 1);
  for (int k = 0; k < 3; ++k) window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 3; }));
  const std::string again = window.frame()["state_hash"];
  EXPECT_EQ(replayed("box_collider", {"--bodies", "200"}, written_changes(window)), again);
  EXPECT_EQ(close(window), "");
}

TEST_F(Viewer, CountsPairsOfAStateThatWasChanged) {
  WindowDriver window({"box_collider", "--bodies", "600", "--steps", "3", "--size", "1280x900"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 3 && f["playing"] == false; }));
  window.move(640, 300);
  const int before = window.frame()["pairs"];
  ASSERT_GT(before, 10);
  window.key("b");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["bodies"] == 601; }));
  EXPECT_GT(window.frame()["pairs"], before / 2);
  EXPECT_GT(window.frame()["contacts"], 0);
  for (int k = 0; k < 12 && window.frame()["selection"].is_null(); ++k)
    window.click_at(560 + 14 * k, 420 - 6 * k);
  ASSERT_FALSE(window.frame()["selection"].is_null());
  window.key("Delete");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["bodies"] == 600; }));
  EXPECT_GT(window.frame()["pairs"], before / 2);
  EXPECT_GT(window.frame()["contacts"], 0);
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope
