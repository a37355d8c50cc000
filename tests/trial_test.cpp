// A trial of a hard case: what it measures and when, what makes it fail, and what its verdict says.

#include "sim_cuda/stability/trial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

class Trials : public OnEachExecutor {
 protected:
  /// A case whose criterion has these members: two spheres in free flight at 1 m/s along x, 4 m apart, in
  /// steps of 1/8 s.
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
  TrialResult run(const HardCase& one, TrialSetting setting = {}, const CriterionFault* fault = nullptr,
                  bool extended = false) {
    setting.executor = GetParam();
    Trial trial(one, setting, options(), extended, fault);
    while (trial.go_on(1000)) {
    }
    EXPECT_TRUE(trial.done());
    EXPECT_EQ(trial.progress(), 1);
    shows_ = trial.fault_shows();
    return trial.result();
  }
  TemporaryFolder folder_;
  bool shows_ = false;
};
ON_EACH_EXECUTOR(Trials);

TEST_P(Trials, PassWhereAllHolds) {
  const TrialResult result = run(flight(R"("steps": 16, "every": 5, "holds": [
    {"quantity": "position", "body": 0, "axis": "x", "at_least": -0.01, "at_most": 2.01},
    {"quantity": "speed", "at_most": 1.5, "at_least": 0.5}])"));
  EXPECT_EQ(result.verdict, Verdict::passed) << result.why;
  EXPECT_EQ(result.why, "");
  EXPECT_EQ(result.steps, 16);
  EXPECT_TRUE(result.state_hash);
  EXPECT_EQ(result.last_good, 16);
  ASSERT_EQ(result.terms.size(), 3u);
  EXPECT_TRUE(result.terms[0].measured && result.terms[0].held);
  EXPECT_NEAR(result.terms[1].value, 2, 1e-5) << "the nearest to a bound";
  EXPECT_EQ(result.terms[1].bound, 2.01);
  EXPECT_EQ(result.terms[1].state, 16);
}

TEST_P(Trials, EndAtTheFirstStateAtWhichATermDoesNotHold) {
  const HardCase one = flight(R"("steps": 16, "every": 5, "holds": [
    {"quantity": "position", "axis": "x", "at_most": 5.5},
    {"quantity": "position", "axis": "x", "at_most": 0, "from": 17, "to": 17}], "long_steps": 20)");
  const TrialResult result = run(one);
  EXPECT_EQ(result.verdict, Verdict::failed);
  EXPECT_EQ(result.failed_term, 1u);
  EXPECT_EQ(result.terms[1].state, 15) << "measured at 0, 5, 10, 15 and 16";
  EXPECT_EQ(result.terms[1].body, 1u);
  EXPECT_NEAR(result.terms[1].value, 5.875, 1e-5);
  EXPECT_EQ(result.last_good, 10);
  EXPECT_EQ(result.steps, 15);
  EXPECT_EQ(result.why, "position x at most 5.5 m: 5.88 m at state 15, body 1");
  EXPECT_FALSE(result.terms[2].measured);

  TrialSetting setting;
  setting.executor = GetParam();
  Snapshot before = state_in_trial(one, setting, options(), result.last_good);
  World world = world_from(before, before.scene, options());
  world.step(5);
  EXPECT_EQ(world.state_hash(), *result.state_hash) << "the same run, made again";
}

TEST_P(Trials, MeasureTheStatesThatTermsName) {
  const std::string holds = R"("every": 16, "holds": [
    {"quantity": "position", "body": 0, "axis": "x", "at_least": 0.37, "at_most": 0.38, "from": 3, "to": 3}])";
  const TrialResult result = run(flight("\"steps\": 16, " + holds));
  EXPECT_EQ(result.verdict, Verdict::passed) << result.why;
  EXPECT_TRUE(result.terms[1].measured);
  EXPECT_EQ(result.terms[1].state, 3);
}

TEST_P(Trials, HaveALongVariant) {
  const HardCase one = flight(R"("steps": 4, "long_steps": 9)");
  EXPECT_EQ(run(one).steps, 4);
  EXPECT_EQ(run(one, {}, nullptr, true).steps, 9);
}

TEST_P(Trials, LimitsAreDeclaredWhereTheyShow) {
  const HardCase one = flight(R"("steps": 4, "holds": [{"quantity": "speed", "at_most": 0.5}],
    "limits": [{"solver": "impulse", "why": "it is fast"}])");
  const TrialResult limit = run(one, {.solver = Solver::impulse});
  EXPECT_EQ(limit.verdict, Verdict::declared_limit);
  EXPECT_EQ(limit.why, "it is fast");
  EXPECT_THAT(limit.failure, HasSubstr("speed at most 0.5 m/s: 1 m/s at state 0"));
  EXPECT_EQ(run(one).verdict, Verdict::failed);
  const TrialResult holds =
      run(flight(R"("steps": 4, "limits": [{"solver": "impulse", "why": "it is fast"}])"),
          {.solver = Solver::impulse});
  EXPECT_EQ(holds.verdict, Verdict::failed);
  EXPECT_THAT(holds.why, HasSubstr("holds, where a limit is declared: remove it"));
}

TEST_P(Trials, DoNotApplyWhereTheSolverRefusesTheScene) {
  HardCase one = flight(R"("steps": 4)");
  one.scene.materials[0].friction = 0.5;
  one.scene.physics.effects = Effects{.rotation = true, .friction = true};
  const TrialResult result = run(one, {.solver = Solver::impulse});
  EXPECT_EQ(result.verdict, Verdict::not_applicable);
  EXPECT_NE(result.why, "");
  EXPECT_EQ(run(one).verdict, Verdict::passed);
  HardCase elsewhere = flight(R"("steps": 4)");
  elsewhere.criterion.executors = {GetParam() == ExecutorKind::cpu ? ExecutorKind::cuda : ExecutorKind::cpu};
  EXPECT_EQ(run(elsewhere).verdict, Verdict::not_applicable);
}

TEST_P(Trials, FailByWhatTheMachineRefuses) {
  HardCase one = flight(R"("steps": 4)");
  RunOptions little = options();
  little.memory_limit = 1;
  Trial trial(one, {.executor = GetParam()}, little);
  while (trial.go_on(1000)) {
  }
  EXPECT_EQ(trial.result().verdict, Verdict::failed);
  EXPECT_THAT(trial.result().why, HasSubstr("bytes"));
  EXPECT_FALSE(trial.result().failed_term);
}

TEST_P(Trials, CompareWithAnotherScene) {
  HardCase one = flight(R"("steps": 8, "holds": [
    {"quantity": "difference", "scene": "moved.json", "offset": [-100, 0, 0], "at_most": 1e-4}],
    "faults": [{"fails": "difference", "step": 3, "body": 1, "velocity": [1.1, 0, 0]}])");
  Scene moved = one.scene;
  for (Body& body : moved.bodies) body.position.x() += 100;
  one.others["moved.json"] = moved;
  EXPECT_EQ(run(one).verdict, Verdict::passed);
  run(one, {}, &one.criterion.faults[0]);
  EXPECT_TRUE(shows_);
}

TEST_P(Trials, CompareOtherShapesAndBroadPhases) {
  HardCase one = flight(R"("steps": 8, "holds": [
    {"quantity": "other_hash", "shapes": [[1, 1], [7, 32]], "broad_phases": ["brute_force"], "at_most": 0}],
    "faults": [{"fails": "other_hash", "step": 8, "body": 1, "velocity": [1.1, 0, 0]}])");
  const TrialResult result = run(one);
  EXPECT_EQ(result.verdict, Verdict::passed);
  EXPECT_TRUE(result.terms[1].measured);
  const TrialResult planted = run(one, {}, &one.criterion.faults[0]);
  EXPECT_TRUE(shows_);
  EXPECT_EQ(planted.terms[1].value, 3);
}

TEST_P(Trials, FaultsShowInTheTermThatTheyAreToFail) {
  const HardCase one = flight(R"("steps": 8, "every": 8, "holds": [{"quantity": "speed", "at_most": 2},
    {"quantity": "displacement", "at_most": 1.5}],
    "faults": [{"fails": "speed", "step": 3, "body": 1, "velocity": [2.1, 0, 0]},
               {"fails": "speed", "step": 3, "body": 1, "velocity": [1.9, 0, 0]},
               {"fails": "displacement", "set": {"time_step": 0.25}},
               {"fails": "finite", "step": 2, "body": 0, "velocity": [null, 0, 0]}])");
  const auto shows = [&](std::size_t fault) {
    run(one, {}, &one.criterion.faults[fault]);
    return shows_;
  };
  EXPECT_TRUE(shows(0)) << "at its own state, too, which is no eighth";
  EXPECT_FALSE(shows(1));
  EXPECT_TRUE(shows(2));
  EXPECT_TRUE(shows(3));
}

TEST_P(Trials, GuardsFindWhatIsPlanted) {
  const HardCase one = flight(R"("steps": 9, "found": {"step": 4, "stage": "bounds", "body": 1},
    "plant": {"step": 3, "body": 1, "position": [0, null, 0]},
    "faults": [{"fails": "found", "step": 5, "body": 1, "position": [0, null, 0]},
               {"fails": "found", "step": 3, "body": 1, "velocity": [0, 1, 0]}])");
  for (const TrialSetting& setting : trials_of(one, GetParam())) {
    const TrialResult result = run(one, setting);
    EXPECT_EQ(result.verdict, Verdict::passed) << result.why;
    EXPECT_EQ(result.steps, 3) << "the run waits before the step";
  }
  for (const CriterionFault& fault : one.criterion.faults) {
    run(one, {}, &fault);
    EXPECT_TRUE(shows_);
  }
  HardCase another = one;
  another.criterion.found->body = 0;
  EXPECT_THAT(run(another).why, HasSubstr("guards find what they must: "));
  EXPECT_THAT(run(another).why, HasSubstr("body 1"));
}

TEST_P(Trials, FailWhereTheScenesOwnGuardsPause) {
  HardCase one = flight(R"("steps": 9)");
  one.scene.physics.guards = Guards{};
  PlantedState& planted = one.criterion.plant.emplace();
  planted.step = 3;
  planted.body = 1;
  planted.velocity = Vector3d(0, 1e12, 0);
  const TrialResult result = run(one);
  EXPECT_EQ(result.verdict, Verdict::failed);
  EXPECT_THAT(result.why, HasSubstr("body 1 has"));
  EXPECT_FALSE(result.failed_term);
  EXPECT_EQ(result.steps, 3);
}

TEST_P(Trials, PlayChanges) {
  HardCase one = flight(R"("steps": 8, "changes": "faster.json", "holds": [
    {"quantity": "position", "body": 0, "axis": "x", "at_least": 1.49, "at_most": 1.51, "from": 8}])");
  std::ofstream(folder_ / "faster.json")
      << R"({"format": "collidoscope-changes", "version": 1, "changes": [{"step": 4, "time_step": 0.25}]})";
  const TrialResult result = run(one);
  EXPECT_EQ(result.verdict, Verdict::passed) << result.why;
}

TEST_P(Trials, RunInSlices) {
  const HardCase one = flight(R"("steps": 500)");
  Trial trial(one, {.executor = GetParam()}, options());
  int slices = 1;
  for (double before = 0; trial.go_on(0); ++slices) {
    EXPECT_GE(trial.progress(), before);
    before = trial.progress();
  }
  EXPECT_GT(slices, 10);
  EXPECT_EQ(trial.result().verdict, Verdict::passed);
}

TEST(RefusedScenes, AreOneTrialThatComparesTheLines) {
  HardCase one;
  one.criterion.refused = {"radius", "mass"};
  one.criterion.executors = {ExecutorKind::cpu};
  EXPECT_EQ(trials_of(one, ExecutorKind::cpu).size(), 1u);
  const auto verdict = [&](std::vector<std::string> lines) {
    one.refusal = std::move(lines);
    Trial trial(one, {}, {});
    EXPECT_FALSE(trial.go_on(1000));
    return trial.result().verdict;
  };
  EXPECT_EQ(verdict({"a radius of 0", "a mass of 0"}), Verdict::passed);
  EXPECT_EQ(verdict({"a mass of 0", "a radius of 0"}), Verdict::failed);
  EXPECT_EQ(verdict({"a radius of 0"}), Verdict::failed);
  EXPECT_EQ(verdict({}), Verdict::failed);
  EXPECT_EQ(trials_of(HardCase{}, ExecutorKind::cpu).size(), 6u);
}

}  // namespace
}  // namespace collidoscope
