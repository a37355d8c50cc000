// Tests `bench frames` through the real program: the parts add up to the frame, and the output names what was
// measured.

#include "headless/bench/frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/run_program.h"

namespace collidoscope {
namespace {

using nlohmann::json;

json measured(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"bench", "frames",     "box_collider", "--bodies",
                                     "300",   "--executor", "cpu",          "--frames",
                                     "5",     "--size",     "320x200"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  arguments.insert(arguments.end(), {"--json", "-"});
  const Outcome outcome = run_headless(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.status == 0 ? json::parse(outcome.out) : json();
}

TEST(Frames, PartsAddUpToTheFrame) {
  const json result = measured({"--layers", "spheres,bvh:1-3,contacts,ui", "--supersample", "2"});
  double share = 0;
  std::vector<std::string> names;
  for (const json& part : result.at("parts")) {
    names.push_back(part.at("name"));
    share += part.at("share").get<double>();
    EXPECT_LE(part.at("p5_ms"), part.at("median_ms"));
    EXPECT_LE(part.at("median_ms"), part.at("p95_ms"));
  }
  EXPECT_THAT(names, testing::ElementsAre("simulate", "publish", "draw", "fill", "ui", "rasterise"));
  EXPECT_NEAR(share, 1, 1e-3);
  const double fps = result.at("frames_per_second");
  EXPECT_GT(fps, 0);
  EXPECT_GT(result.at("frame").at("p95_ms").get<double>() * fps, 999) << "no frame is longer than the 95th";
  EXPECT_FALSE(result.at("draw_passes").empty());
}

TEST(Frames, ResultsSayWhatWasMeasured) {
  const json result = measured({"--layers", "spheres,bvh:1-3,contacts", "--quality", "full", "--supersample",
                                "3", "--sphere-method", "compute"});
  EXPECT_EQ(result.at("suite"), "frames");
  EXPECT_EQ(result.at("bodies"), 300);
  EXPECT_EQ(result.at("variant"), "paper");
  EXPECT_EQ(result.at("layers"), "spheres,bvh:1-3,contacts");
  EXPECT_EQ(result.at("quality"), "full");
  EXPECT_EQ(result.at("supersampling"), 3);
  EXPECT_EQ(result.at("sphere_method"), "compute");
  EXPECT_EQ(result.at("width"), 320);
  EXPECT_EQ(result.at("frames"), 5);
  EXPECT_EQ(result.at("steps"), 5 + result.at("warm_up_frames").get<int>());
  EXPECT_EQ(result.at("drawn").at("bodies"), 300);
  EXPECT_GT(result.at("drawn").at("contacts").get<int>(), 0);
  EXPECT_EQ(result.at("drawn").at("contacts"), result.at("pairs").at("touching"));
  EXPECT_GT(result.at("drawn").at("boxes"), 8);
  EXPECT_EQ(result.at("display_path"), "CPU + upload");
  for (const char* text : {"device", "renderer", "opengl", "state_hash"})
    EXPECT_FALSE(result.at(text).get<std::string>().empty()) << text;
}

TEST(Frames, LookingChangesNothing) {
  const json plain = measured({"--layers", "spheres"});
  const Outcome run = run_headless(
      {"run", "box_collider", "--bodies", "300", "--steps", plain.at("steps").dump(), "--json", "-"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(json::parse(run.out).at("state_hash"), plain.at("state_hash"));
}

TEST(Frames, ATableForPeople) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_headless({"bench", "frames", "--bodies", "50", "--executor", "cpu", "--frames", "2", "--size",
                    "160x120", "--layers", "spheres,ui", "--json", folder / "frames.json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* line : {"Box Collider: 50 bodies", "simulate", "publish", "draw: 3D view", "ui: panels",
                           "whole frame", "frames per second", "hash "})
    EXPECT_THAT(outcome.out, testing::HasSubstr(line));
  EXPECT_EQ(json::parse(text_of(folder / "frames.json")).at("bodies"), 50);
}

}  // namespace
}  // namespace collidoscope
