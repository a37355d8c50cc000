// Tests the files of auto-tuners: their members follow the schemas, and their numbers are those of the
// search.

#include "headless/tuning/tuner_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "tests/invented_search.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::Pair;

std::string key_of(LaunchShape shape) {
  return std::to_string(shape.blocks) + "," + std::to_string(shape.threads);
}

std::map<std::string, LaunchCell> by_key(const LaunchSearch& search) {
  std::map<std::string, LaunchCell> cells;
  for (const LaunchCell& cell : search.cells()) cells[key_of(cell.shape)] = cell;
  return cells;
}

/// Shapes by state, of a search that has all states.
std::map<LaunchCell::State, int> counts(const LaunchSearch& search) {
  std::map<LaunchCell::State, int> counts;
  for (const LaunchCell& cell : search.cells()) ++counts[cell.state];
  return counts;
}

TEST(KernelTunerCache, HasTheMembersOfItsSchema) {
  const LaunchSearch search = invented_search();
  const std::string text = kernel_tuner_cache(invented_run(search), search);
  EXPECT_TRUE(text.ends_with("}\n}\n")) << "Kernel Tuner takes other files for unfinished ones";
  const json file = json::parse(text);
  EXPECT_EQ(file["schema_version"], "1.0.0");
  EXPECT_EQ(file["device_name"], "A GPU");
  EXPECT_EQ(file["kernel_name"], "Box Collider, step after state 60");
  EXPECT_EQ(file["problem_size"], json::array({50'000}));
  EXPECT_EQ(file["tune_params_keys"], json::array({"blocks", "threads"}));
  EXPECT_EQ(file["objective"], "time");
  EXPECT_LT(text.find("\"objective\""), text.find("\"cache\"")) << "the cache is last";
  for (const auto& [key, entry] : file["cache"].items()) {
    const int blocks = entry["blocks"], threads = entry["threads"];
    EXPECT_EQ(key, key_of({blocks, threads}));
    EXPECT_THAT(file["tune_params"]["blocks"], Contains(blocks));
    EXPECT_THAT(file["tune_params"]["threads"], Contains(threads));
    EXPECT_EQ(entry["compile_time"], 0);
    EXPECT_EQ(entry["verification_time"], 1.5);
    EXPECT_EQ(entry["benchmark_time"], 40);
    EXPECT_EQ(entry["strategy_time"], 0.25);
    EXPECT_EQ(entry["framework_time"], 5);
    EXPECT_EQ(entry["timestamp"], "2026-01-02T03:04:05Z");
  }
}

TEST(KernelTunerCache, HasTheTimesOfEachShapeAndTheReasonsOfInvalidOnes) {
  const LaunchSearch search = invented_search();
  auto numbers = counts(search);
  ASSERT_GT(numbers[LaunchCell::State::left_out], 0);
  ASSERT_EQ(numbers[LaunchCell::State::infeasible], 2);
  ASSERT_EQ(numbers[LaunchCell::State::wrong], 1);
  const json cache = json::parse(kernel_tuner_cache(invented_run(search), search))["cache"];
  for (const auto& [key, cell] : by_key(search)) {
    if (cell.state == LaunchCell::State::left_out) {
      EXPECT_FALSE(cache.contains(key)) << "it was not evaluated";
      continue;
    }
    const json& entry = cache.at(key);
    if (cell.state == LaunchCell::State::measured) {
      EXPECT_EQ(entry["time"], 2.36 * cell.estimate().ratio);
      EXPECT_EQ(entry["times"], json(cell.ms));
      EXPECT_EQ(entry["ratio"], cell.estimate().ratio);
      EXPECT_EQ(entry.contains("ratio_high"), cell.ratios.size() >= 6) << cell.ratios.size();
      EXPECT_FALSE(entry.contains("__error__"));
    } else {
      EXPECT_EQ(entry["time"], "RuntimeFailedConfig");
      EXPECT_EQ(entry["__error__"], "RuntimeFailedConfig");
      EXPECT_FALSE(entry.contains("times"));
    }
  }
  EXPECT_EQ(cache["1056,1024"]["reason"], "infeasible: too many resources requested for launch");
  EXPECT_EQ(cache[key_of(wrong_shape)]["reason"], "wrong hash: state 62: hash 0000000000000001, expected 2");
}

TEST(KernelTunerCache, ShapesThatWereNotReachedAreMissing) {
  const LaunchSearch search = invented_search(30);
  ASSERT_GT(counts(search)[LaunchCell::State::waiting], 0);
  const json file = json::parse(kernel_tuner_cache(invented_run(search), search));
  for (const auto& [key, cell] : by_key(search))
    if (cell.state == LaunchCell::State::waiting) {
      EXPECT_FALSE(file["cache"].contains(key));
    }
}

TEST(KernelTunerCache, OfASearchWithoutAMeasurementIsClosed) {
  const LaunchSearch search({1}, {32}, 32, 32);
  const std::string text = kernel_tuner_cache(invented_run(search), search);
  EXPECT_TRUE(text.ends_with("}\n}\n")) << text;
  EXPECT_TRUE(json::parse(text)["cache"].empty());
}

TEST(T4Results, HaveTheMembersOfTheirSchema) {
  const LaunchSearch search = invented_search();
  const json file = json::parse(t4_results(invented_run(search), search));
  EXPECT_EQ(file["schema_version"], "1.0.0");
  EXPECT_EQ(file["metadata"]["timeunit"], "milliseconds");
  EXPECT_EQ(file["metadata"]["device"], "A GPU");
  std::map<std::string, int> invalidities;
  std::map<std::string, LaunchCell> cells = by_key(search);
  for (const json& result : file["results"]) {
    EXPECT_EQ(result["timestamp"], "2026-01-02T03:04:05Z");
    EXPECT_EQ(result["objectives"], json::array({"time"}));
    EXPECT_EQ(result["times"]["compilation_time"], 0);
    EXPECT_EQ(result["times"]["framework"], 5);
    EXPECT_EQ(result["times"]["search_algorithm"], 0.25);
    EXPECT_EQ(result["times"]["validation"], 1.5);
    const std::string invalidity = result["invalidity"];
    ++invalidities[invalidity];
    EXPECT_EQ(result["correctness"], invalidity == "correct" ? 1 : 0);
    const json& configuration = result["configuration"];
    const LaunchCell& cell = cells.at(key_of({configuration["blocks"], configuration["threads"]}));
    const json& first = result["measurements"][0];
    if (invalidity == "correct") {
      EXPECT_EQ(first, json({{"name", "time"}, {"value", 2.36 * cell.estimate().ratio}, {"unit", "ms"}}));
      EXPECT_EQ(result["measurements"][1]["value"], cell.estimate().ratio);
      EXPECT_EQ(result["times"]["runtimes"], json(cell.ms));
    } else {
      EXPECT_EQ(first, json({{"name", "reason"}, {"value", cell.reason}, {"unit", ""}}));
      EXPECT_TRUE(result["times"]["runtimes"].empty());
    }
    EXPECT_EQ(invalidity == "correctness", cell.shape == wrong_shape);
  }
  EXPECT_THAT(invalidities, Contains(Pair("correctness", 1)));
  EXPECT_THAT(invalidities, Contains(Pair("runtime", 2)));
  EXPECT_EQ(invalidities["correct"], counts(search)[LaunchCell::State::measured]);
  EXPECT_EQ(invalidities.size(), 3u);
}

}  // namespace
}  // namespace collidoscope
