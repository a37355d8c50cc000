// Tests the report of a run as JSON and as a table: exact numbers, null for unknown values, and the width of
// lines.
#include "headless/reporting/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sim_cuda/core/physics_version.h"

namespace collidoscope {
namespace {

using nlohmann::json;

RunReport example() {
  RunReport report;
  report.scene = "Example";
  report.variant = "paper";
  report.seed = 18446744073709551615u;
  report.executor = "cpu";
  report.device = "A processor";
  report.broad_phase = "bvh_bottom_up";
  report.solver = "impulse";
  report.precision = "f32";
  report.effects = {"gravity"};
  report.time_step = 1.0 / 30;
  report.final.step = 40;
  report.final.bodies = 1234567;
  report.final.pairs = 20;
  report.final.kinetic_energy = 0.1;
  report.times = {
      .step_median_ms = 1.5,
      .step_p95_ms = 2,
      .steps_timed = 20,
      .stages = {
          {.name = "bounds",
           .median_ms = 0.25,
           .p95_ms = 0.5,
           .launches = 1,
           .launch = {.items = 1000, .blocks = 2, .threads = 2, .chunk = 512, .limit = LaunchLimit::threads},
           .samples = 10},
          {.name = "sort",
           .median_ms = 0.75,
           .p95_ms = 1,
           .launches = 7,
           .library_launch = true,
           .samples = 10}}};
  report.state_hash = 0xabc;
  report.wall_seconds = 0.5;
  return report;
}

TEST(Report, JsonKeepsEveryBitOfANumber) {
  RunReport report = example();
  report.final.max_penetration = 0.1 + 0.2;
  const json read = json::parse(to_json(report));
  EXPECT_EQ(read["max_penetration"].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(read["time_step"].get<double>(), 1.0 / 30);
  EXPECT_EQ(read["seed"].get<std::uint64_t>(), 18446744073709551615u);
  EXPECT_EQ(read["state_hash"], "0000000000000abc");
  EXPECT_EQ(read["physics_version"], physics_version);
  EXPECT_THAT(to_json(report), testing::HasSubstr("\"kinetic\": 0.1,"));
}

TEST(Report, JsonSaysWhatStagesWereLaunchedAs) {
  RunReport report = example();
  json read = json::parse(to_json(report));
  const json bounds = read["stages"][0]["launch"];
  EXPECT_EQ(bounds["items"], 1000);
  EXPECT_EQ(bounds["chunk"], 512);
  EXPECT_EQ(bounds["limit"], "threads");
  EXPECT_TRUE(bounds["occupancy"].is_null()) << "of a GPU alone";
  EXPECT_TRUE(read["stages"][1]["launch"].is_null());
  report.times.stages[1].launch = {.items = 10,
                                   .blocks = 1,
                                   .threads = 256,
                                   .resident_blocks = 8,
                                   .multiprocessors = 132,
                                   .occupancy = 1,
                                   .limit = LaunchLimit::items};
  read = json::parse(to_json(report));
  EXPECT_EQ(read["stages"][1]["launch"]["limit"], "too few items");
  EXPECT_EQ(read["stages"][1]["launch"]["occupancy"], 1.0);
  EXPECT_TRUE(read["stages"][1]["launch"]["chunk"].is_null());
}

TEST(Report, WhatIsNotFiniteIsNull) {
  RunReport report = example();
  report.final.kinetic_energy = std::numeric_limits<double>::quiet_NaN();
  report.final.momentum[1] = std::numeric_limits<double>::infinity();
  report.final.non_finite = 3;
  const json read = json::parse(to_json(report));
  EXPECT_TRUE(read["energy"]["final"].is_null());
  EXPECT_TRUE(read["momentum"][1].is_null());
  EXPECT_EQ(read["non_finite"], 3);
}

TEST(Report, SaysWhoSleepsWhereSomethingCan) {
  RunReport report = example();
  EXPECT_FALSE(json::parse(to_json(report)).contains("sleep"));
  EXPECT_THAT(to_text(report), testing::Not(testing::HasSubstr("asleep")));
  report.final.can_sleep = true;
  report.final.asleep = 1234000;
  report.final.islands = 9;
  report.final.islands_asleep = 7;
  const json sleep = json::parse(to_json(report))["sleep"];
  EXPECT_EQ(sleep["asleep"], 1234000);
  EXPECT_EQ(sleep["awake"], 567);
  EXPECT_EQ(sleep["islands"], 9);
  EXPECT_EQ(sleep["islands_asleep"], 7);
  EXPECT_THAT(to_text(report), testing::HasSubstr("1,234,000 of 1,234,567 bodies; islands 7 of 9\n"));
}

TEST(Report, SaysWhatEachSweepLeft) {
  RunReport report = example();
  EXPECT_FALSE(json::parse(to_json(report)).contains("residuals"));
  report.residuals = {{"solve", 0, 0, 12, 0.5, 1.25}, {"relax", 3, 2, 10, 0.125, 0.25}};
  const json read = json::parse(to_json(report))["residuals"];
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1]["stage"], "relax");
  EXPECT_EQ(read[1]["substep"], 3);
  EXPECT_EQ(read[1]["iteration"], 2);
  EXPECT_EQ(read[1]["contacts"], 10);
  EXPECT_EQ(read[1]["rms"], 0.125);
  EXPECT_EQ(read[0]["max"], 1.25);
  EXPECT_THAT(to_text(report), testing::HasSubstr("0.125 m/s rms over 10 contacts, 0.25 m/s max\n"));
}

TEST(Report, ATimeThatWasNotTakenIsNull) {
  RunReport report = example();
  for (StageTime& stage : report.times.stages) stage.samples = 0;
  const json stages = json::parse(to_json(report))["stages"];
  ASSERT_EQ(stages.size(), 2u);
  EXPECT_TRUE(stages[0]["median_ms"].is_null() && stages[0]["p95_ms"].is_null()) << stages[0];
  EXPECT_EQ(stages[0]["launches"], 1);
  EXPECT_THAT(to_text(report), testing::ContainsRegex("bounds +- +- "));
  EXPECT_THAT(to_text(report), testing::ContainsRegex("sum of the stages +- +8\n"));
  report.times = {};
  const json read = json::parse(to_json(report));
  EXPECT_TRUE(read["step_median_ms"].is_null());
  EXPECT_TRUE(read["stages"].empty());
  EXPECT_THAT(to_text(report), testing::Not(testing::HasSubstr("whole step")));
}

TEST(Report, ANameThatIsNotUtf8StaysJson) {
  RunReport report = example();
  report.scene = "bad \xff name";
  EXPECT_TRUE(json::accept(to_json(report)));
}

TEST(Report, TheTableShowsSharesAndMarksOwnShapes) {
  const std::string text = to_text(example());
  EXPECT_THAT(text, testing::ContainsRegex("bounds +0.2500 +0.5000 +25.0 % +1\n"));
  EXPECT_THAT(text, testing::ContainsRegex("sort \\* +0.7500 +1.0000 +75.0 % +7\n"));
  EXPECT_THAT(text, testing::ContainsRegex("sum of the stages +1.0000 +8\n"));
  EXPECT_THAT(text, testing::ContainsRegex("whole step, no timers +1.5000 +2.0000\n"));
  EXPECT_THAT(text, testing::HasSubstr("1,234,567 bodies, paper"));
  EXPECT_THAT(text, testing::HasSubstr("steps of 1/30 s"));
}

TEST(Report, LinesFitATerminalAndEndInNoBlank) {
  std::istringstream text(to_text(example()));
  for (std::string line; std::getline(text, line);) {
    EXPECT_LE(line.size(), 80u) << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
}

}  // namespace
}  // namespace collidoscope
