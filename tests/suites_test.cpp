// The suites that compare broad phases, run as a user runs them.

#include "headless/bench/suites.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

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
  EXPECT_GT(report["correlations"].size(), 10u);
  for (const json& score : report["correlations"])
    for (const char* which :
         {"same_query_within_scenes", "same_query_all", "own_query_within_scenes", "own_query_all"}) {
      EXPECT_GE(score[which], -1.0000001);
      EXPECT_LE(score[which], 1.0000001);
    }
  // At each N the tree over the bodies as they come is visited most.
  std::map<int, std::pair<double, std::string>> worst;
  for (const json& row : report["rows"])
    worst[row["bodies"]] =
        std::max(worst[row["bodies"]], {row["visits, mean"].get<double>(), row["method"].get<std::string>()});
  ASSERT_EQ(worst.size(), 2u);
  for (const auto& [bodies, of] : worst) EXPECT_EQ(of.second, "bvh_input_order") << bodies;
}

TEST(Suites, ThePaperOwnsItsShapesAndSaysWhatItClaims) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string() + "/";
  const Outcome run = run_headless({"bench", "paper", box, "--executor", "cpu", "--sizes", "1000", "--json",
                                    at + "r.json", "--plot", at + "r.png"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json report = json::parse(text_of(at + "r.json"));
  EXPECT_EQ(report["rows"].size(), 2u + 3 * 6);
  for (const json& row : report["rows"]) {
    EXPECT_GT(row["ms"], 0);
    if (row["table"] == 5) {
      EXPECT_GT(row["sort_ms"], 0);
      EXPECT_LT(row["sort_ms"], row["ms"]);
    }
  }
  EXPECT_EQ(report["recursion"].size(), 2u);
  EXPECT_THAT(run.out, HasSubstr("by calls"));
  EXPECT_THAT(run.out, HasSubstr("eats up the speedup"));
  EXPECT_GT(read_png(at + "r.png").width, 1000);
}

TEST(Suites, EveryEffectIsFreeWhereItIsOffAndSeenWhereItIsOn) {
  const Outcome run = run_headless({"bench", "effects", "box_collider_scaled", "--executor", "cpu",
                                    "--bodies", "300", "--repeats", "4", "--json", "-"});
  ASSERT_EQ(run.status, 0) << run.err << run.out;
  const json report = json::parse(run.out);
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
  // Frictionless spheres that cannot turn: nothing is stored of how they turn, or of friction.
  for (const char* absent :
       {"orientations", "angular velocities", "inertia", "friction of contacts", "friction at walls"})
    EXPECT_FALSE(report["effects"][0]["without"]["buffers"].contains(absent)) << absent;
  const Outcome refused = run_headless({"bench", "effects", "rolling", "--executor", "cpu"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("calls for gravity alone"));
}

TEST(Suites, RefuseWhatCannotBeWrittenBeforeTheyMeasure) {
  const Outcome run =
      run_headless({"bench", "scaling", box, "--executor", "cpu", "--plot", "/no/such/folder/chart.png"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("--plot"));
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(run_headless({"bench", "scaling", "two_spheres_head_on", "--executor", "cpu"}).status, 2);
}

}  // namespace
}  // namespace collidoscope
