// Tests the ring buffer of the last steps, its summaries, and its output as CSV and JSON.

#include "sim_cuda/run/history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

namespace collidoscope {
namespace {

StageTime stage(const char* name, double last_ms) {
  StageTime time;
  time.name = name;
  time.last_ms = last_ms;
  time.launches = 2;
  return time;
}

// Step k: odd steps are not timed by stage and take k ms. Even steps take k ms in "a" and 1 ms in "b".
History filled(std::size_t capacity, int steps) {
  History history(capacity);
  for (int k = 1; k <= steps; ++k) {
    HistoryStep step;
    step.step = k;
    step.measured = k % 3 == 0;
    step.stats.kinetic_energy = 0.5 * k;
    if (k % 2 == 1) {
      step.plain_ms = k;
      history.add(step, {});
    } else {
      history.add(step, {stage("a", k), stage("b", 1)});
    }
  }
  return history;
}

TEST(History, KeepsTheNewest) {
  const History history = filled(7, 100);
  ASSERT_EQ(history.size(), 7u);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(history[i].step, 94 + static_cast<std::int64_t>(i));
  EXPECT_TRUE(history[0].instrumented());
  EXPECT_FALSE(history[1].instrumented());
}

TEST(History, SummariesAreThoseOfTheWindow) {
  const History history = filled(50, 21);
  // The last 10 steps are 12 to 21. The even ones, 12, 14, 16, 18 and 20, are timed by stage.
  const TimeSummary a = history.summarize_stage(0, 10);
  EXPECT_EQ(a.samples, 5);
  EXPECT_EQ(a.now, 20);
  EXPECT_EQ(a.median, 16);
  EXPECT_NEAR(a.p95, 18 + 0.8 * 2, 1e-5);
  EXPECT_EQ(history.summarize_sum(10).median, 17);
  const TimeSummary plain = history.summarize_plain(10);
  EXPECT_EQ(plain.samples, 5);
  EXPECT_EQ(plain.median, 17);
  EXPECT_EQ(plain.now, 21);
  EXPECT_EQ(history.summarize_stage(7, 10).samples, 0);
  EXPECT_EQ(History().summarize_plain(10).samples, 0);
}

TEST(History, StagesThatComeLateAreNotMixedUp) {
  History history;
  history.add({}, {stage("a", 1), stage("b", 2)});
  history.add({}, {stage("c", 3), stage("b", 4)});
  ASSERT_EQ(history.stages().size(), 3u);
  EXPECT_THAT(history[1].stage_ms, testing::ElementsAre(-1.0f, 4.0f, 3.0f));
  EXPECT_EQ(history[1].stage_sum(), 7);
  EXPECT_EQ(history.summarize_stage(0, 10).samples, 1);
}

TEST(History, KnowsTheNewestLaunchOfEachStage) {
  History history;
  StageTime a = stage("a", 1), b = stage("b", 2);
  a.launch.blocks = 8;
  history.add({}, {a, b});
  a.launch.blocks = 16;
  history.add({}, {a});
  history.add({}, {});
  EXPECT_EQ(history.stages()[0].launch.blocks, 16);
  EXPECT_TRUE(history.current(0));
  EXPECT_FALSE(history.current(1)) << "the newest step has none such";
  EXPECT_FALSE(History().current(0));
}

TEST(History, CsvHasAFieldForEachColumn) {
  std::istringstream text(history_csv(filled(50, 9), 4));
  std::string line;
  std::vector<std::string> lines;
  while (std::getline(text, line)) lines.push_back(line);
  ASSERT_EQ(lines.size(), 5u);
  const auto commas = [](const std::string& row) { return std::count(row.begin(), row.end(), ','); };
  for (const std::string& row : lines) EXPECT_EQ(commas(row), commas(lines[0])) << row;
  EXPECT_THAT(lines[0], testing::HasSubstr(",pairs,touching,speculative,nodes,"));
  EXPECT_TRUE(lines[0].ends_with(",a_ms,b_ms"));
  EXPECT_TRUE(lines[1].starts_with("6,,7,")) << lines[1];
  EXPECT_TRUE(lines[1].ends_with(",6,1")) << lines[1];
  EXPECT_TRUE(lines[2].starts_with("7,7,,")) << lines[2];
}

TEST(History, JsonSaysTheSame) {
  History history = filled(50, 9);
  HistoryStep broken;
  broken.step = 10;
  broken.measured = true;
  broken.stats.kinetic_energy = std::nan("");
  broken.stats.touching = 3;
  broken.stats.speculative = 8;
  history.add(broken, {});
  const auto document = nlohmann::json::parse(history_json(history, 5));
  ASSERT_EQ(document["steps"].size(), 5u);
  EXPECT_EQ(document["steps"][0]["step"], 6);
  EXPECT_EQ(document["steps"][0]["stage_ms"]["a"], 6.0);
  EXPECT_EQ(document["steps"][0]["kinetic"], 3.0);
  EXPECT_TRUE(document["steps"][1]["stage_ms"].is_null());
  EXPECT_TRUE(document["steps"][4]["kinetic"].is_null());
  EXPECT_EQ(document["steps"][4]["touching"], 3);
  EXPECT_EQ(document["steps"][4]["speculative"], 8);
  EXPECT_EQ(document["stages"][0]["name"], "a");
  EXPECT_EQ(document["stages"][0]["median_ms"], 7.0);
}

}  // namespace
}  // namespace collidoscope
