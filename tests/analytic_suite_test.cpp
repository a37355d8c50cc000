// Tests the output of `accuracy` without a scene, in every format. Each result and each failure with its
// reason must be listed.

#include "headless/accuracy/analytic_suite.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "headless/cli/command_line.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

AnalyticResult result(std::string name, Integrator integrator, Precision precision, Theory theory,
                      double error) {
  AnalyticResult r;
  r.name = std::move(name);
  r.compared = "position, m";
  r.rationale = "so it is";
  r.method.integrator = integrator;
  r.precision = precision;
  r.method.theory = std::move(theory);
  for (const int rate : {30, 60, 120, 240}) {
    const double h = 1.0 / rate, share = r.method.theory.claim == Claim::exact ? 1 : 30.0 / rate;
    r.levels.push_back({h, rate, error * share, tolerance(r.method.theory, h, 1e-12)});
  }
  evaluate(r);
  return r;
}

std::vector<AnalyticResult> results() {
  const Theory first = leading_theory(1, 3);
  return {result("throw", Integrator::semi_implicit_euler, Precision::f64, first, 0.1),
          result("throw", Integrator::semi_implicit_euler, Precision::f32, first, 0.1),
          result("meet", Integrator::semi_implicit_euler, Precision::f64, {}, 1e-15),
          result("fail", Integrator::semi_implicit_euler, Precision::f64, first, 0.2)};
}

TEST(AnalyticSuite, WritesEveryResultAsJson) {
  const auto json = nlohmann::json::parse(analytic_json(results(), "a machine"));
  EXPECT_EQ(json["device"], "a machine");
  EXPECT_EQ(json["physics_version"], physics_version);
  EXPECT_EQ(json["failed"], 1);
  ASSERT_EQ(json["cases"].size(), 4u);
  const auto& thrown = json["cases"][0];
  EXPECT_EQ(thrown["name"], "throw");
  EXPECT_EQ(thrown["integrator"], "semi_implicit_euler");
  EXPECT_EQ(thrown["solver"], "soft_step");
  EXPECT_EQ(thrown["precision"], "f64");
  EXPECT_EQ(thrown["claim"], "leading");
  EXPECT_EQ(thrown["order"], 1);
  EXPECT_NEAR(thrown["fitted_order"].get<double>(), 1, 1e-12);
  EXPECT_TRUE(thrown["passed"]);
  ASSERT_EQ(thrown["levels"].size(), 4u);
  EXPECT_EQ(thrown["levels"][3]["error"], 0.0125);
  EXPECT_EQ(thrown["levels"][3]["theory"], 0.0125);
  EXPECT_TRUE(json["cases"][2]["order"].is_null()) << "exact";
  EXPECT_TRUE(json["cases"][2]["levels"][0]["theory"].is_null());
  EXPECT_FALSE(json["cases"][3]["passed"]);
}

TEST(AnalyticSuite, WritesARowOfCsvForEachStep) {
  std::vector<AnalyticResult> all = results();
  all[3].method.rotation_update = RotationUpdate::first_order;
  const std::string csv = analytic_csv(all);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 4 * 4);
  EXPECT_THAT(csv,
              testing::HasSubstr("\nfail,\"semi_implicit_euler, first_order\",soft_step,f64,leading,1,"));
  EXPECT_THAT(csv, testing::HasSubstr("\nmeet,semi_implicit_euler,soft_step,f64,exact,,,"));
  EXPECT_THAT(csv, testing::HasSubstr("\nthrow,semi_implicit_euler,soft_step,f32,leading,1,,"));
}

TEST(AnalyticSuite, SaysWhatFailedAndWhy) {
  const std::string text = analytic_text(results(), "a machine");
  EXPECT_THAT(text, testing::HasSubstr("a machine: 3 cases, 4 runs at 4 step sizes each, 1 failed"));
  EXPECT_THAT(
      text, testing::HasSubstr(
                "\nfail, semi_implicit_euler, f64: at h = 0.03333 s the error is 0.2; the limit is 0.122\n"));
  EXPECT_THAT(text, testing::HasSubstr("FAILED"));
  EXPECT_THAT(text, testing::HasSubstr("1/30 - 1/240"));
  const std::string markdown = analytic_markdown(results(), "a machine");
  EXPECT_THAT(markdown, testing::HasSubstr(
                            "| `throw`: position, m | semi_implicit_euler | 1.00 of 1 | 1/240 | 0.013 |"));
  EXPECT_EQ(std::ranges::count(markdown, '\n'), 1 + 1 + 2 + 3) << "double and float share a row";
  const std::string table = markdown.substr(markdown.find('|'));
  EXPECT_EQ(std::ranges::count(table, '|'), 5 * 10) << "nine columns in each row";
}

TEST(AnalyticSuite, DrawsDoubleAndFloatOfEachIntegratorInOneColour) {
  const Chart chart = analytic_chart(results(), "throw");
  ASSERT_EQ(chart.series.size(), 2u);
  EXPECT_EQ(chart.series[0].name, "semi_implicit_euler, f64");
  EXPECT_EQ(chart.series[0].color, chart.series[1].color);
  EXPECT_TRUE(chart.series[1].dashed);
  EXPECT_EQ(chart.series[0].points.front().x, 1.0 / 240) << "left to right";
  EXPECT_EQ(chart.y.label, "error of position, m");
}

TEST(AnalyticSuite, RefusesFlagsOfScenes) {
  const CommandLine line =
      parse_command_line({"accuracy", "--substeps", "4", "--gravity", "0,0,0", "--tolerance", "1"});
  try {
    analytic_suite(line);
    FAIL() << "ran";
  } catch (const InputError& error) {
    ASSERT_EQ(error.lines().size(), 3u);
    EXPECT_THAT(error.lines()[0], testing::StartsWith("--gravity: set by the analytic cases"));
    EXPECT_THAT(error.lines()[1], testing::StartsWith("--substeps: "));
    EXPECT_THAT(error.lines()[2], testing::StartsWith("--tolerance: "));
  }
}

TEST(AnalyticSuite, NeedsACase) {
  const CommandLine line =
      parse_command_line({"accuracy", "--solver", "jacobi_split", "--integrator", "rk4"});
  try {
    analytic_suite(line);
    FAIL() << "ran";
  } catch (const InputError& error) {
    ASSERT_EQ(error.lines().size(), 1u);
    EXPECT_THAT(error.lines()[0], testing::StartsWith("--integrator, --solver: no analytic case"));
  }
}

TEST(AnalyticSuite, IsAccuracyWithoutAScene) {
  const TemporaryFolder folder;
  const Outcome all = run_headless({"accuracy", "--precision", "f64", "--json", "-", "--csv",
                                    folder / "a.csv", "--markdown", folder / "a.md"});
  EXPECT_EQ(all.status, 0) << all.err;
  const auto json = nlohmann::json::parse(all.out);
  EXPECT_EQ(json["failed"], 0);
  EXPECT_GE(json["cases"].size(), 14u);
  EXPECT_THAT(text_of(folder / "a.csv"), testing::HasSubstr("\norbit,rk4,soft_step,f64,leading,4,"));
  EXPECT_THAT(text_of(folder / "a.md"), testing::HasSubstr("all pass"));
  const Outcome refused = run_headless({"accuracy", "--steps", "3"});
  EXPECT_EQ(refused.status, 2);
}

TEST(AnalyticSuite, ScenesHaveBareNames) {
  EXPECT_THAT(scene_file("zeno"), testing::EndsWith("scenes/analytic/zeno.json"));
  EXPECT_THAT(scene_file("orbits"), testing::EndsWith("scenes/orbits.json"));
}

}  // namespace
}  // namespace collidoscope
