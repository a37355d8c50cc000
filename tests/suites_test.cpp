// Tests the benchmark suites through the real program: a row for each method, their fits, and the claims of
// the paper.

#include "headless/bench/suites.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "headless/bench/paper_report.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/world.h"
#include "tests/run_program.h"
#include "viewer/render/image.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* box = "box_collider";

TEST(Suites, EveryMethodHasARowAndAPicture) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string() + "/";
  const Outcome run =
      run_headless({"bench", "broad-phases", box, "--executor", "cpu", "--sizes", "50,200", "--variants",
                    "scaled,equal", "--repeats", "2", "--json", at + "r.json", "--csv", at + "r.csv",
                    "--markdown", at + "r.md", "--plot", at + "r.png"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json report = json::parse(text_of(at + "r.json"));
  EXPECT_EQ(report["physics_version"], physics_version);
  ASSERT_EQ(report["rows"].size(), 2 * 2 * broad_phase_names().size());
  std::map<std::pair<std::string, int>, std::set<std::int64_t>> pairs;
  for (const json& row : report["rows"]) {
    pairs[{row["variant"], row["bodies"]}].insert(row["pairs"].get<std::int64_t>());
    EXPECT_GT(row["median_us"], 0);
    EXPECT_LE(row["p5_us"], row["median_us"]);
    EXPECT_GE(row["p95_us"], row["median_us"]);
    EXPECT_GT(row["launches"], 0);
  }
  for (const auto& [scene, counts] : pairs)
    EXPECT_EQ(counts.size(), 1u) << scene.first << ' ' << scene.second;
  EXPECT_THAT(text_of(at + "r.csv"), StartsWith("method,variant,bodies,pairs,"));
  EXPECT_THAT(text_of(at + "r.md"), HasSubstr("| `lbvh_ropes` |"));
  EXPECT_GT(read_png(at + "r.png").width, 1000);
}

TEST(Suites, ScalingFitsEveryMethod) {
  const Outcome run =
      run_headless({"bench", "scaling", box, "--executor", "cpu", "--sizes", "50,100,200,400,800",
                    "--methods", "lbvh_ropes,brute_force", "--repeats", "3", "--json", "-"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json report = json::parse(run.out);
  EXPECT_EQ(report["physics_version"], physics_version);
  ASSERT_EQ(report["growth"].size(), 2u);
  EXPECT_EQ(report["rows"].size(), 10u);
  for (const json& growth : report["growth"]) {
    EXPECT_GT(growth["exponent"], 0);
    EXPECT_LE(growth["exponent_least"], growth["exponent"]);
    EXPECT_GE(growth["exponent_most"], growth["exponent"]);
    EXPECT_GE(growth["fixed_us"], 0);
  }
}

TEST(Suites, PredictorsRankEveryMeasure) {
  const Outcome run = run_headless({"bench", "predictors", box, "--executor", "cpu", "--sizes", "300,600",
                                    "--variants", "scaled", "--repeats", "2", "--json", "-"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json report = json::parse(run.out);
  EXPECT_EQ(report["physics_version"], physics_version);
  EXPECT_GT(report["correlations"].size(), 10u);
  for (const json& score : report["correlations"])
    for (const char* which :
         {"same_query_within_scenes", "same_query_all", "own_query_within_scenes", "own_query_all"}) {
      EXPECT_GE(score[which], -1.0000001);
      EXPECT_LE(score[which], 1.0000001);
    }
  // At each N the tree in input order has the most visits.
  std::map<int, std::pair<double, std::string>> worst;
  for (const json& row : report["rows"])
    worst[row["bodies"]] = std::max(
        worst[row["bodies"]], {row["root visits, mean"].get<double>(), row["method"].get<std::string>()});
  ASSERT_EQ(worst.size(), 2u);
  for (const auto& [bodies, of] : worst) EXPECT_EQ(of.second, "bvh_input_order") << bodies;
}

TEST(Suites, CrowdedScenesKeepDefaultKeysGood) {
  const auto visits = [](const char* bits) {
    const Outcome run =
        run_headless({"bench", "broad-phases", box, "--executor", "cpu", "--sizes", "2000", "--methods",
                      "lbvh_ropes,bvh_bottom_up", "--key-bits", bits, "--repeats", "1", "--json", "-"});
    EXPECT_EQ(run.status, 0) << run.err;
    std::map<std::pair<std::string, std::string>, double> of;
    const json report = json::parse(run.out);
    for (const json& row : report["rows"]) {
      of[{row["variant"], row["method"]}] = row["own_visits_mean"];
      if (std::string(bits) != "auto") {
        EXPECT_EQ(std::to_string(row["key_bits"].get<int>()), bits);
      }
    }
    return of;
  };
  auto by_default = visits("auto"), best = visits("24");
  for (const char* bits : {"30", "63"})
    for (const auto& [row, mean] : visits(bits)) best[row] = std::min(best[row], mean);
  std::set<std::string> scenes;
  for (const auto& [row, mean] : by_default) {
    scenes.insert(row.first);
    EXPECT_LE(mean, 2 * best[row]) << row.first << ", " << row.second;
  }
  EXPECT_THAT(scenes, testing::ElementsAre("clusters", "log_normal", "mixed", "paper"));
}

// The number of levels equals the one in the file. No kernel is launched for a level that does not exist.
TEST(Suites, TopDownBuildsNoEmptyLevel) {
  const Outcome run =
      run_headless({"bench", "broad-phases", box, "--executor", "cpu", "--sizes", "3000", "--methods",
                    "lbvh_top_down", "--variants", "scaled", "--repeats", "1", "--json", "-"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Outcome tree =
      run_headless({"bvh", box, "--executor", "cpu", "--bodies", "3000", "--variant", "scaled", "--methods",
                    "lbvh_top_down", "--repeats", "1", "--json", "-"});
  ASSERT_EQ(tree.status, 0) << tree.err;
  EXPECT_EQ(json::parse(tree.out)["physics_version"], physics_version);
  const json levels = json::parse(tree.out)["trees"][0]["levels"];
  int launches = 0;
  const json report = json::parse(run.out);
  for (const json& stage : report["rows"][0]["stages"])
    if (stage["name"] == "build") launches = stage["launches"];
  EXPECT_EQ(launches, levels.get<int>() + 2) << "the root, a launch a level, the boxes";
}

TEST(Suites, EveryThreadTakesPartInThePapersSort) {
  for (const char* threads : {"4", "8", "16", "50"}) {
    const Outcome run =
        run_headless({"run", box, "--executor", "cpu", "--bodies", "1000", "--steps", "2", "--sort", "radix",
                      "--blocks", "16", "--threads", threads, "--json", "-"});
    ASSERT_EQ(run.status, 0) << run.err;
    const json stages = json::parse(run.out)["stages"];
    const auto sort = std::ranges::find(stages, "sort", [](const json& stage) { return stage["name"]; });
    ASSERT_NE(sort, stages.end());
    EXPECT_EQ((*sort)["launch"]["items"], 16 * std::stoi(threads));
  }
}

TEST(Suites, ThePaperOwnsItsShapesAndSaysWhatItClaims) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string() + "/";
  const Outcome run =
      run_headless({"bench", "paper", box, "--executor", "cpu", "--sizes", "1000", "--repeats", "3", "--json",
                    at + "r.json", "--csv", at + "r.csv", "--markdown", at + "r.md", "--plot", at + "r.png"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json report = json::parse(text_of(at + "r.json"));
  EXPECT_EQ(report["physics_version"], physics_version);
  EXPECT_EQ(report["rows"].size(), 2u + 6 + 2 * 6 + 2 * 6);
  std::map<std::string, std::set<std::int64_t>> pairs;
  std::map<std::string, int> queries;
  for (const json& row : report["rows"]) {
    EXPECT_GT(row["ms"], 0);
    EXPECT_LE(row["p5_ms"], row["ms"]);
    EXPECT_GE(row["p95_ms"], row["ms"]);
    EXPECT_GT(row["allocated_bytes"], 0);
    EXPECT_EQ(row["timed_steps"], 3) << "--repeats";
    EXPECT_EQ(row["steps"], 6);
    pairs["all"].insert(row["pairs"].get<std::int64_t>());
    if (row["table"] < 3) {
      EXPECT_TRUE(row["query"].is_null());
      continue;
    }
    ++queries[row["query"]];
    if (row["table"] == 5) {
      EXPECT_GT(row["sort_ms"], 0);
      EXPECT_LT(row["sort_ms"], row["ms"]);
    }
  }
  EXPECT_EQ(pairs["all"].size(), 1u) << "whole queries find the pairs of half queries";
  EXPECT_EQ(queries["whole"], 12);
  EXPECT_EQ(queries["half"], 12);
  EXPECT_EQ(report["recursion"].size(), 2u);
  EXPECT_THAT(run.out, HasSubstr("ms with recursive calls"));
  EXPECT_THAT(run.out, HasSubstr("eats up the speedup\" (whole queries)"));
  EXPECT_THAT(run.out, HasSubstr("eats up the speedup\" (half queries)"));
  for (const char* column : {"p5", "p95", "bytes", "query"}) EXPECT_THAT(run.out, HasSubstr(column));
  EXPECT_THAT(text_of(at + "r.csv"), HasSubstr("p5_ms,p95_ms"));
  EXPECT_THAT(text_of(at + "r.md"), HasSubstr("(p5 to p95)"));
  EXPECT_GT(read_png(at + "r.png").width, 1000);
  EXPECT_EQ(run_headless({"bench", "paper", box, "--executor", "cpu", "--sizes", "7"}).status, 2);
}

/// Table 5 for two shapes, the second with an efficiency of `share`.
std::string claims_at(double share) {
  PaperResults results;
  for (const PaperCell& cell : paper_cells())
    if (cell.table == 5 && cell.bodies == 1000 && cell.blocks * cell.threads <= 16) {
      const double ms = cell.blocks * cell.threads == 8 ? 1 : 0.5 / share;
      PaperRow row{cell, PaperQuery::whole, {ms, ms, ms}, {}};
      row.timing.sort_stage = {0.1 * ms, 0.1 * ms, 0.1 * ms};
      results.rows.push_back(row);
    }
  return paper_text(results, false);
}

TEST(Suites, EightyPercentAreConfirmedFromEightyPercentOn) {
  EXPECT_THAT(claims_at(0.73), HasSubstr("measured 73.0 %: not confirmed"));
  EXPECT_THAT(claims_at(0.79), HasSubstr("measured 79.0 %: not confirmed"));
  EXPECT_THAT(claims_at(0.81), HasSubstr("measured 81.0 %: confirmed"));
}

TEST(Suites, EveryEffectIsFreeWhereItIsOffAndSeenWhereItIsOn) {
  const Outcome run = run_headless({"bench", "effects", "box_collider_scaled", "--executor", "cpu",
                                    "--bodies", "300", "--repeats", "4", "--json", "-"});
  ASSERT_EQ(run.status, 0) << run.err << run.out;
  const json report = json::parse(run.out);
  EXPECT_EQ(report["physics_version"], physics_version);
  std::set<std::string> seen;
  for (const json& row : report["effects"]) {
    seen.insert(row["effect"].get<std::string>());
    EXPECT_TRUE(row["off_costs_nothing"].get<bool>()) << row["effect"];
    EXPECT_TRUE(row["on_is_seen"].get<bool>()) << row["effect"];
    EXPECT_EQ(row["without"]["launches"], row["off"]["launches"]);
    EXPECT_EQ(row["without"]["buffers"], row["off"]["buffers"]);
    EXPECT_EQ(row["without"]["state_hash"] == row["on"]["state_hash"], row["effect"] == "guards");
  }
  for (const EffectName& effect : effect_names)
    EXPECT_TRUE(seen.contains(std::string(effect.name))) << effect.name;
  // Frictionless spheres without rotation: no rotation or friction data is stored.
  for (const char* absent :
       {"orientations", "angular velocities", "inertia", "contact friction", "wall friction"})
    EXPECT_FALSE(report["effects"][0]["without"]["buffers"].contains(absent)) << absent;
  const Outcome refused = run_headless({"bench", "effects", "rolling", "--executor", "cpu"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("needs only gravity"));
}

TEST(Suites, RefuseWhatCannotBeWrittenBeforeTheyMeasure) {
  const Outcome run =
      run_headless({"bench", "scaling", box, "--executor", "cpu", "--plot", "/no/such/folder/chart.png"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("--plot"));
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(run_headless({"bench", "scaling", "two_spheres_head_on", "--executor", "cpu"}).status, 2);
}

TEST(Suites, PrintNoNumberThatIsNotKnown) {
  const TemporaryFolder folder;
  const std::string csv = folder / "c", file = folder / "j", markdown = folder / "m";
  const Outcome solvers = run_headless(
      {"bench", "solvers", "empty", "--repeats", "1", "--csv", csv, "--json", file, "--markdown", markdown});
  ASSERT_EQ(solvers.status, 0) << solvers.err;
  for (const std::string& text : {solvers.out, text_of(csv), text_of(markdown)})
    EXPECT_THAT(text, testing::Not(HasSubstr("nan")));
  EXPECT_THAT(solvers.out,
              testing::ContainsRegex("soft_step .*iteration[s]? +[0-9.]+ +1.00 \\(1.00-1.00\\) .* -\n"));
  EXPECT_TRUE(json::parse(text_of(file))["rows"][0]["speed_rms"].is_null());
  EXPECT_EQ(json::parse(text_of(file))["physics_version"], physics_version);

  const Outcome scaling =
      run_headless({"bench", "scaling", box, "--executor", "cpu", "--sizes", "10,20,40", "--methods",
                    "brute_force", "--repeats", "1", "--json", file, "--markdown", markdown});
  ASSERT_EQ(scaling.status, 0) << scaling.err;
  EXPECT_THAT(scaling.out, testing::ContainsRegex("brute_force +[a-z]+ +- +too few sizes +- +[0-9.]+\n"));
  EXPECT_THAT(text_of(markdown), HasSubstr("| - | too few sizes | - |"));
  EXPECT_TRUE(json::parse(text_of(file))["growth"][0]["relative_error"].is_null());
}

}  // namespace
}  // namespace collidoscope
