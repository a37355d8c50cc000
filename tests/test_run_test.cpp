// Tests a test run of a hard case: its measured states, the conditions that make it fail, and its reported
// outcome.

#include "sim_cuda/stability/test_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

class TestRuns : public OnEachExecutor {
 protected:
  /// A case whose criterion has `members`: two spheres in free flight at 1 m/s along x, 4 m apart, in steps
  /// of 1/8 s.
  HardCase flight(const std::string& members) {
    HardCase one;
    one.name = "flight";
    one.scene = empty_space();
    one.scene.physics.solver = Solver::soft_step;
    one.scene.physics.time_step = 0.125;
    one.scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(1, 0, 0)),
                        sphere(1, Vector3d(4, 0, 0), Vector3d(1, 0, 0))};
    one.file = folder_ / "flight.json";
    std::ofstream(one.file) << write_scene(one.scene);
    one.criterion = parse_criterion(R"({"format": "collidoscope-criterion", "version": 1, "what": "w",
      "group": "rest", )" + members + "}",
                                    "c", &one.scene);
    return one;
  }
  TestResult run(const HardCase& one, TestConfiguration configuration = {},
                 const InjectedFault* fault = nullptr, bool extended = false) {
    configuration.executor = GetParam();
    TestRun test_run(one, configuration, options(), extended, fault);
    while (test_run.advance(1000)) {
    }
    EXPECT_TRUE(test_run.done());
    EXPECT_EQ(test_run.progress(), 1);
    shows_ = test_run.fault_detected();
    return test_run.result();
  }
  TemporaryFolder folder_;
  bool shows_ = false;
};
ON_EACH_EXECUTOR(TestRuns);

TEST_P(TestRuns, PassWhereAllHolds) {
  const TestResult result = run(flight(R"("steps": 16, "every": 5, "assertions": [
    {"quantity": "position", "body": 0, "axis": "x", "at_least": -0.01, "at_most": 2.01},
    {"quantity": "speed", "at_most": 1.5, "at_least": 0.5}])"));
  EXPECT_EQ(result.outcome, TestOutcome::passed) << result.why;
  EXPECT_EQ(result.why, "");
  EXPECT_EQ(result.steps, 16);
  EXPECT_TRUE(result.state_hash);
  EXPECT_EQ(result.last_passing_state, 16);
  ASSERT_EQ(result.assertions.size(), 3u);
  EXPECT_TRUE(result.assertions[0].measured && result.assertions[0].passed);
  EXPECT_NEAR(result.assertions[1].value, 2, 1e-5) << "the nearest to a bound";
  EXPECT_EQ(result.assertions[1].bound, 2.01);
  EXPECT_EQ(result.assertions[1].state, 16);
}

TEST_P(TestRuns, EvaluateAllTerms) {
  const HardCase one = flight(R"("steps": 16, "every": 5, "assertions": [
    {"quantity": "position", "axis": "x", "at_most": 5.5},
    {"quantity": "position", "axis": "x", "at_most": 5, "from": 16, "to": 16},
    {"quantity": "position", "axis": "x", "at_most": 0, "from": 17, "to": 17}], "long_steps": 20)");
  const TestResult result = run(one);
  EXPECT_EQ(result.outcome, TestOutcome::failed);
  EXPECT_EQ(result.failed_assertion, 1u);
  EXPECT_EQ(result.assertions[1].state, 15) << "measured at 0, 5, 10, 15 and 16";
  EXPECT_EQ(result.assertions[1].body, 1u);
  EXPECT_NEAR(result.assertions[1].value, 5.875, 1e-5);
  EXPECT_EQ(result.last_passing_state, 10);
  EXPECT_EQ(result.steps, 16);
  EXPECT_EQ(result.why,
            "position x at most 5.5 m: 5.88 m at state 15, body 1; up to 6 m; "
            "position x at most 5 m at state 16: 6 m at state 16, body 1");
  EXPECT_NEAR(result.assertions[1].worst(), 6, 1e-5);
  EXPECT_TRUE(result.assertions[2].measured);
  EXPECT_FALSE(result.assertions[3].measured);

  TestConfiguration configuration;
  configuration.executor = GetParam();
  Snapshot before = replay_to_state(one, configuration, options(), result.last_passing_state);
  World world = world_from(before, before.scene, options());
  world.step(6);
  EXPECT_EQ(world.state_hash(), *result.state_hash) << "the same run, made again";
}

TEST_P(TestRuns, MeasureTheStatesThatTermsName) {
  const std::string holds = R"("every": 16, "assertions": [
    {"quantity": "position", "body": 0, "axis": "x", "at_least": 0.37, "at_most": 0.38, "from": 3, "to": 3}])";
  const TestResult result = run(flight("\"steps\": 16, " + holds));
  EXPECT_EQ(result.outcome, TestOutcome::passed) << result.why;
  EXPECT_TRUE(result.assertions[1].measured);
  EXPECT_EQ(result.assertions[1].state, 3);
}

TEST_P(TestRuns, HaveALongVariant) {
  const HardCase one = flight(R"("steps": 4, "long_steps": 9)");
  EXPECT_EQ(run(one).steps, 4);
  EXPECT_EQ(run(one, {}, nullptr, true).steps, 9);
}

// Body 1 moves at 1 m/s from x = 4 m.
TEST_P(TestRuns, LimitsNameTermsAndBounds) {
  const auto limited = [&](const std::string& assertions, const std::string& fails, Solver solver) {
    return run(
        flight(R"("steps": 4, "assertions": [{"quantity": "speed", "at_most": 0.5})" + assertions +
               R"(], "limits": [{"solver": "impulse", "why": "it is fast", "fails": [)" + fails + "]}]"),
        {.solver = solver});
  };
  const std::string speed = R"({"quantity": "speed", "at_most": 1.5})",
                    position = R"(, {"quantity": "position", "axis": "x", "at_most": 4.2})";
  const TestResult limit = limited("", speed, Solver::impulse);
  EXPECT_EQ(limit.outcome, TestOutcome::expected_failure);
  EXPECT_EQ(limit.why, "it is fast");
  EXPECT_EQ(limit.failure, "speed at most 0.5 m/s: 1 m/s at state 0, body 0");
  EXPECT_EQ(limited("", speed, Solver::soft_step).outcome, TestOutcome::failed);

  const TestResult unrelated = limited(position, speed, Solver::impulse);
  EXPECT_EQ(unrelated.outcome, TestOutcome::failed);
  EXPECT_THAT(unrelated.why, testing::StartsWith("position x at most 4.2 m: 4.25 m at state 2, body 1"));
  EXPECT_THAT(unrelated.failure, HasSubstr("speed at most"));

  const TestResult beyond = limited("", R"({"quantity": "speed", "at_most": 0.75})", Solver::impulse);
  EXPECT_EQ(beyond.outcome, TestOutcome::failed);
  EXPECT_THAT(beyond.why, testing::EndsWith("; the declared limit is speed at most 0.75 m/s"));

  const TestResult holds = limited(R"(, {"quantity": "position", "axis": "x", "at_most": 9})",
                                   speed + R"(, {"quantity": "position", "at_most": 10})", Solver::impulse);
  EXPECT_EQ(holds.outcome, TestOutcome::failed);
  EXPECT_THAT(holds.why, HasSubstr("position x at most 9 m: holds although a limit is declared"));
}

TEST_P(TestRuns, AreMadeForSomeSolvers) {
  const HardCase one = flight(R"("steps": 4, "solvers": ["soft_step", "jacobi_split"])");
  EXPECT_EQ(run(one, {.solver = Solver::impulse}).outcome, TestOutcome::not_applicable);
  EXPECT_EQ(run(one, {.solver = Solver::impulse}).why, "not made for impulse");
  EXPECT_EQ(run(one, {.solver = Solver::soft_step}).outcome, TestOutcome::passed);
}

TEST_P(TestRuns, DoNotApplyWhereTheSolverRefusesTheScene) {
  HardCase one = flight(R"("steps": 4)");
  one.scene.materials[0].friction = 0.5;
  one.scene.physics.effects = Effects{.rotation = true, .friction = true};
  const TestResult result = run(one, {.solver = Solver::impulse});
  EXPECT_EQ(result.outcome, TestOutcome::not_applicable);
  EXPECT_NE(result.why, "");
  EXPECT_EQ(run(one).outcome, TestOutcome::passed);
  HardCase elsewhere = flight(R"("steps": 4)");
  elsewhere.criterion.executors = {GetParam() == ExecutorKind::cpu ? ExecutorKind::cuda : ExecutorKind::cpu};
  EXPECT_EQ(run(elsewhere).outcome, TestOutcome::not_applicable);
}

TEST_P(TestRuns, FailByWhatTheMachineRefuses) {
  HardCase one = flight(R"("steps": 4)");
  RunOptions little = options();
  little.memory_limit = 1;
  TestRun test_run(one, {.executor = GetParam()}, little);
  while (test_run.advance(1000)) {
  }
  EXPECT_EQ(test_run.result().outcome, TestOutcome::failed);
  EXPECT_THAT(test_run.result().why, HasSubstr("bytes"));
  EXPECT_FALSE(test_run.result().failed_assertion);
}

TEST_P(TestRuns, CompareWithAnotherScene) {
  HardCase one = flight(R"("steps": 8, "assertions": [
    {"quantity": "difference", "scene": "moved.json", "offset": [-100, 0, 0], "at_most": 1e-4}],
    "injected_faults": [{"fails": "difference", "step": 3, "body": 1, "velocity": [1.1, 0, 0]}])");
  Scene moved = one.scene;
  for (Body& body : moved.bodies) body.position.x() += 100;
  one.others["moved.json"] = moved;
  EXPECT_EQ(run(one).outcome, TestOutcome::passed);
  run(one, {}, &one.criterion.injected_faults[0]);
  EXPECT_TRUE(shows_);
}

TEST_P(TestRuns, CompareOtherShapesAndBroadPhases) {
  HardCase one = flight(R"("steps": 8, "assertions": [
    {"quantity": "other_hash", "shapes": [[1, 1], [7, 32]], "broad_phases": ["brute_force"], "at_most": 0}],
    "injected_faults": [{"fails": "other_hash", "step": 8, "body": 1, "velocity": [1.1, 0, 0]}])");
  const TestResult result = run(one);
  EXPECT_EQ(result.outcome, TestOutcome::passed);
  EXPECT_TRUE(result.assertions[1].measured);
  const TestResult injected = run(one, {}, &one.criterion.injected_faults[0]);
  EXPECT_TRUE(shows_);
  EXPECT_EQ(injected.assertions[1].value, 3);
}

TEST_P(TestRuns, FaultsShowInTheTermThatTheyAreToFail) {
  const HardCase one = flight(R"("steps": 8, "every": 8, "assertions": [{"quantity": "speed", "at_most": 2},
    {"quantity": "displacement", "at_most": 1.5}],
    "injected_faults": [{"fails": "speed", "step": 3, "body": 1, "velocity": [2.1, 0, 0]},
               {"fails": "speed", "step": 3, "body": 1, "velocity": [1.9, 0, 0]},
               {"fails": "displacement", "set": {"time_step": 0.25}},
               {"fails": "finite", "step": 2, "body": 0, "velocity": [null, 0, 0]}])");
  const auto shows = [&](std::size_t fault) {
    run(one, {}, &one.criterion.injected_faults[fault]);
    return shows_;
  };
  EXPECT_TRUE(shows(0)) << "at its own state, too, which is no eighth";
  EXPECT_FALSE(shows(1));
  EXPECT_TRUE(shows(2));
  EXPECT_TRUE(shows(3));
}

TEST_P(TestRuns, GuardsFindWhatIsPlanted) {
  const HardCase one = flight(R"("steps": 9, "expect_finding": {"step": 4, "stage": "bounds", "body": 1},
    "inject": {"step": 3, "body": 1, "position": [0, null, 0]},
    "injected_faults": [{"fails": "found", "step": 5, "body": 1, "position": [0, null, 0]},
               {"fails": "found", "step": 3, "body": 1, "velocity": [0, 1, 0]}])");
  for (const TestConfiguration& configuration : test_configurations(one, GetParam())) {
    const TestResult result = run(one, configuration);
    EXPECT_EQ(result.outcome, TestOutcome::passed) << result.why;
    EXPECT_EQ(result.steps, 3) << "the run waits before the step";
  }
  for (const InjectedFault& fault : one.criterion.injected_faults) {
    run(one, {}, &fault);
    EXPECT_TRUE(shows_);
  }
  HardCase another = one;
  another.criterion.expected_finding->body = 0;
  EXPECT_THAT(run(another).why, HasSubstr("guards report the expected finding: "));
  EXPECT_THAT(run(another).why, HasSubstr("body 1"));
}

TEST_P(TestRuns, FailWhereTheScenesOwnGuardsPause) {
  HardCase one = flight(R"("steps": 9)");
  one.scene.physics.guards = ValidationSettings{};
  InjectedState& injected = one.criterion.injected_state.emplace();
  injected.step = 3;
  injected.body = 1;
  injected.velocity = Vector3d(0, 1e12, 0);
  const TestResult result = run(one);
  EXPECT_EQ(result.outcome, TestOutcome::failed);
  EXPECT_THAT(result.why, HasSubstr("body 1 has"));
  EXPECT_FALSE(result.failed_assertion);
  EXPECT_EQ(result.steps, 3);
}

TEST_P(TestRuns, PlayChanges) {
  HardCase one = flight(R"("steps": 8, "changes": "faster.json", "assertions": [
    {"quantity": "position", "body": 0, "axis": "x", "at_least": 1.49, "at_most": 1.51, "from": 8}])");
  std::ofstream(folder_ / "faster.json")
      << R"({"format": "collidoscope-changes", "version": 1, "changes": [{"step": 4, "time_step": 0.25}]})";
  const TestResult result = run(one);
  EXPECT_EQ(result.outcome, TestOutcome::passed) << result.why;
}

TEST_P(TestRuns, RunInSlices) {
  const HardCase one = flight(R"("steps": 500)");
  TestRun test_run(one, {.executor = GetParam()}, options());
  int slices = 1;
  for (double before = 0; test_run.advance(0); ++slices) {
    EXPECT_GE(test_run.progress(), before);
    before = test_run.progress();
  }
  EXPECT_GT(slices, 10);
  EXPECT_EQ(test_run.result().outcome, TestOutcome::passed);
}

TEST(RefusedScenes, AreOneTrialThatComparesTheLines) {
  HardCase one;
  one.criterion.refused = {"radius", "mass"};
  one.criterion.executors = {ExecutorKind::cpu};
  EXPECT_EQ(test_configurations(one, ExecutorKind::cpu).size(), 1u);
  const auto outcome = [&](std::vector<std::string> lines) {
    one.refusal = std::move(lines);
    TestRun test_run(one, {}, {});
    EXPECT_FALSE(test_run.advance(1000));
    return test_run.result().outcome;
  };
  EXPECT_EQ(outcome({"a radius of 0", "a mass of 0"}), TestOutcome::passed);
  EXPECT_EQ(outcome({"a mass of 0", "a radius of 0"}), TestOutcome::failed);
  EXPECT_EQ(outcome({"a radius of 0"}), TestOutcome::failed);
  EXPECT_EQ(outcome({}), TestOutcome::failed);
  EXPECT_EQ(test_configurations(HardCase{}, ExecutorKind::cpu).size(), 6u);
}

}  // namespace
}  // namespace collidoscope
