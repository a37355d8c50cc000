// Tests the results of test runs as a table and as JSON.

#include "headless/stability/stability_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "sim_cuda/core/physics_version.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

HardCase named(const std::string& name, const std::string& group) {
  HardCase hard_case;
  hard_case.name = name;
  hard_case.criterion.group = group;
  hard_case.criterion.what = "it holds";
  Assertion& assertion = hard_case.criterion.assertions.emplace_back();
  assertion.quantity = Quantity::penetration;
  assertion.at_most = 0.5;
  return hard_case;
}

TestResult result(TestOutcome outcome) {
  TestResult r;
  r.outcome = outcome;
  r.assertions = {{true, outcome == TestOutcome::passed, 0.25, 0.5, 7, 3, 0.25, 0.25}};
  r.steps = 10;
  r.state_hash = 0xabcu;
  r.seconds = 0.5;
  if (outcome == TestOutcome::passed) return r;
  r.failed_assertion = 0;
  r.failure = "penetration: too deep";
  r.why = outcome == TestOutcome::failed ? r.failure : "as it must be";
  return r;
}

TEST(StabilityReport, TellsEachTrial) {
  HardCase stack = named("stack", "stacks"), bad = named("bad", "bad input");
  bad.criterion.refused = {"a"};
  stack.criterion.expected_failures = {{Solver::impulse, {}, {}, {{0, 2.0, {}}}, "as it must be"}};
  StabilityRun run{"a machine", ExecutorKind::cpu, false, 2.5, 5, {}};
  run.rows = {
      {&stack, {Solver::impulse, Precision::f32, ExecutorKind::cpu}, result(TestOutcome::expected_failure)},
      {&stack, {Solver::soft_step, Precision::f32, ExecutorKind::cpu}, result(TestOutcome::passed)},
      {&stack, {Solver::soft_step, Precision::f64, ExecutorKind::cpu}, result(TestOutcome::failed)},
      {&bad, {}, result(TestOutcome::passed)}};
  const std::string text = stability_text(run);
  EXPECT_THAT(text, testing::ContainsRegex("\nstacks\n  stack  +limit  +ok  +FAIL  +1[.]50\n"));
  EXPECT_THAT(text, HasSubstr("    stack, soft_step f64: penetration: too deep\n"));
  EXPECT_THAT(text, testing::ContainsRegex("\nbad input\n  bad  +ok  "));
  EXPECT_THAT(text,
              HasSubstr("declared limits\n  stack, impulse f32: as it must be (penetration: too deep)\n"));
  EXPECT_THAT(text,
              HasSubstr("4 trials of 2 cases on a machine: 2 passed, 1 failed, 1 declared limit (one in 4); "
                        "0 not applicable; 2.5 s; interrupted, 1 trials not finished\n"));

  const auto json = nlohmann::json::parse(stability_json(run));
  EXPECT_EQ(json["suite"], "stability");
  EXPECT_EQ(json["physics_version"], physics_version);
  EXPECT_EQ(json["device"], "a machine");
  EXPECT_EQ(json["executor"], "cpu");
  EXPECT_FALSE(json["complete"]);
  EXPECT_EQ(json["passed"], 2);
  EXPECT_EQ(json["failed"], 1);
  EXPECT_EQ(json["declared_limits"], 1);
  ASSERT_EQ(json["cases"].size(), 2u);
  EXPECT_EQ(json["cases"][0]["what"], "it holds");
  EXPECT_EQ(json["cases"][0]["limits"][0]["solver"], "impulse");
  EXPECT_TRUE(json["cases"][0]["limits"][0]["precision"].is_null());
  EXPECT_EQ(json["cases"][0]["limits"][0]["fails"][0], "penetration at most 2 m");
  const auto& failed = json["trials"][2];
  EXPECT_EQ(failed["case"], "stack");
  EXPECT_EQ(failed["solver"], "soft_step");
  EXPECT_EQ(failed["precision"], "f64");
  EXPECT_EQ(failed["verdict"], "failed");
  EXPECT_EQ(failed["failing_state"], 7);
  EXPECT_EQ(failed["failing_body"], 3);
  EXPECT_EQ(failed["state_hash"], "0000000000000abc");
  EXPECT_EQ(failed["terms"][0]["quantity"], "penetration");
  EXPECT_EQ(failed["terms"][0]["worst"], 0.25);
  EXPECT_EQ(failed["terms"][0]["bound"], 0.5);
  EXPECT_TRUE(json["trials"][3]["solver"].is_null());
}

TEST(StabilityReport, TellsWhichFaultsShow) {
  HardCase stack = named("stack", "stacks");
  stack.criterion.injected_faults.resize(2);
  const std::vector<InjectedFaultRow> rows{{&stack, 0, true, result(TestOutcome::passed)},
                                           {&stack, 1, false, result(TestOutcome::passed)}};
  const std::string text = injected_faults_text(rows);
  EXPECT_THAT(text, testing::ContainsRegex("stack  +ok    penetration at most 0.5 m: 0.25 m at state 7\n"));
  EXPECT_THAT(text,
              testing::ContainsRegex("stack  +FAIL  penetration at most 0.5 m: passed despite fault 2\n"));
  EXPECT_THAT(text, HasSubstr("2 faults injected: 1 not detected\n"));
  const auto json = nlohmann::json::parse(injected_faults_json(rows));
  EXPECT_TRUE(json["planted"][0]["shows"]);
  EXPECT_FALSE(json["planted"][1]["shows"]);
  EXPECT_EQ(json["physics_version"], physics_version);
}

}  // namespace
}  // namespace collidoscope
