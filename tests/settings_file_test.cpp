// Tests the settings file of the panels: round trip, invalid content, other versions, and an atomic write.

#include "viewer/session/settings_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/core/error.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

TEST(SettingsFile, ComesBackAsItWas) {
  Workspace before;
  before.theme = Theme::light;
  before.font_scale = 1.25f;
  before.speed = 0.25;
  before.layers.boxes = true;
  before.layers.grid = false;
  before.layers.first_level = 2;
  before.layers.last_level = 5;
  before.levels_chosen = true;
  before.layers.color = BodyColor::visits;
  before.layers.box_color = NodeMetric::empty_space;
  before.visible_panels.right = false;
  before.visible_panels.camera = false;
  before.breaks.limit(BreakCondition::speed) = 12.5;
  before.breaks.on.fill(true);
  Workspace after;
  EXPECT_EQ(read_settings(settings_text(before), after), "");
  EXPECT_EQ(after.layers, before.layers);
  EXPECT_EQ(after.visible_panels, before.visible_panels);
  EXPECT_EQ(after.theme, before.theme);
  EXPECT_TRUE(after.levels_chosen);
  EXPECT_EQ(after.font_scale, before.font_scale);
  EXPECT_EQ(after.speed, before.speed);
  EXPECT_EQ(after.breaks.limits, before.breaks.limits);
  EXPECT_FALSE(after.breaks.conditions().any()) << "nobody stops where nobody asked this time";
}

TEST(SettingsFile, NonsenseIsLeftOut) {
  for (const char* text : {"", "{", "[]", "{}", R"({"format": 3})", "\xff\xfe"}) {
    Workspace workspace;
    EXPECT_THAT(read_settings(text, workspace), testing::HasSubstr("ignored")) << text;
    EXPECT_EQ(workspace.layers, window_layers());
  }
  Workspace workspace;
  EXPECT_EQ(
      read_settings(R"({"format": "collidoscope-settings", "font_scale": 1e9, "speed": "fast", "color": 77,
      "first_level": -3, "last_level": 9.5, "shown": {"spheres": 1, "grid": false, "none": true},
      "break_limits": {"speed": -1, "penetration": "deep", "stage-ms": 1e99, "escaped": 3, "energy-rise": 7}})",
                    workspace),
      "");
  EXPECT_EQ(workspace.font_scale, 1);
  EXPECT_EQ(workspace.speed, 1);
  EXPECT_EQ(workspace.layers.color, BodyColor::speed);
  EXPECT_EQ(workspace.layers.first_level, 0);
  EXPECT_EQ(workspace.layers.last_level, 9);
  EXPECT_TRUE(workspace.layers.spheres);
  BreakRequests limits;
  limits.limit(BreakCondition::energy_rise) = 7;
  EXPECT_EQ(workspace.breaks.limits, limits.limits);
  EXPECT_FALSE(workspace.layers.grid);
}

TEST(SettingsFile, ASpeedIsOneOfTheList) {
  Workspace workspace;
  EXPECT_EQ(read_settings(R"({"format": "collidoscope-settings", "version": 1, "speed": 0.3})", workspace),
            "");
  EXPECT_EQ(workspace.speed, 1);
  EXPECT_EQ(read_settings(R"({"format": "collidoscope-settings", "version": 1, "speed": 0.5})", workspace),
            "");
  EXPECT_EQ(workspace.speed, 0.5);
}

TEST(SettingsFile, OtherVersionsAndPipesAreLeftAlone) {
  const TemporaryFolder folder;
  const std::string file = (folder / "settings.json").string();
  Workspace workspace;
  EXPECT_EQ(read_settings_file(file, workspace).fault, "") << "there is none yet";
  EXPECT_TRUE(read_settings_file(file, workspace).may_be_written);
  std::ofstream(file) << R"({"format": "collidoscope-settings", "version": 99, "theme": "light"})";
  EXPECT_THAT(read_settings_file(file, workspace).fault, testing::HasSubstr("another version"));
  EXPECT_FALSE(read_settings_file(file, workspace).may_be_written);
  EXPECT_EQ(workspace.theme, Theme::dark);
  std::ofstream(file) << "nonsense";
  EXPECT_THAT(read_settings_file(file, workspace).fault, testing::HasSubstr("ignored"));
  EXPECT_TRUE(read_settings_file(file, workspace).may_be_written);
  std::filesystem::remove(file);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_THAT(read_settings_file(file, workspace).fault, testing::HasSubstr("not a regular file"));
  EXPECT_FALSE(read_settings_file(file, workspace).may_be_written);
}

TEST(AtomicFile, IsWrittenOrAsItWas) {
  const TemporaryFolder folder;
  const std::string file = (folder / "a/b/c.json").string();
  write_file_atomically(file, "one");
  write_file_atomically(file, "two");
  std::ifstream stream(file);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "two");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "a/b"), {}), 1);
  EXPECT_THROW(write_file_atomically(file + "/below", "x"), MachineError);
}

}  // namespace
}  // namespace collidoscope
