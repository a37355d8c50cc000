// Tests a run with an invalid step, through the real program: message, exit status and snapshot. A run from
// the snapshot must fail in the same way.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "tests/run_program.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// Body 1 falls freely and reaches 5 m/s in the step to state 16.
class FailingRun : public testing::Test {
 protected:
  FailingRun() {
    Scene scene;
    scene.name = "One falls";
    scene.obstacles.push_back(Plane{});
    scene.bodies = {sphere(0.5, Vector3d(0, 0, 0.5)), sphere(0.5, Vector3d(9, 0, 100))};
    scene.physics.guards = ValidationSettings{.speed = 5};
    write(scene_, scene);
    scene.physics.guards.reset();
    write(plain_, scene);
  }
  static void write(const std::string& file, const Scene& scene) {
    std::ofstream(file) << write_scene(scene);
  }

  TemporaryFolder folder_;
  std::string scene_ = folder_ / "scene.json", plain_ = folder_ / "plain.json",
              saved_ = folder_ / "saved.snapshot";
};

constexpr const char* line = "stage forces of step 16, substep 2: body 1 has the velocity 5.0685 m/s";

TEST_F(FailingRun, EndsBeforeTheStepAndLeavesWhatReproducesIt) {
  const Outcome failed =
      run_headless({"run", scene_, "--executor", "cpu", "--steps", "40", "--save", saved_, "--json", "-"});
  EXPECT_EQ(failed.status, 1);
  EXPECT_EQ(failed.err, std::string(line) + "; state 15 before the failure saved to " + saved_ + "\n");
  const json report = json::parse(failed.out);
  EXPECT_EQ(report["steps"], 15);
  EXPECT_EQ(report["failure"], line);
  EXPECT_EQ(report["guards"]["on_failure"], "pause");
  EXPECT_TRUE(report["guards"]["frozen"].empty());
  const json finding = report["guards"]["finding"];
  EXPECT_EQ(finding["stage"], "forces");
  EXPECT_EQ(finding["step"], 16);
  EXPECT_EQ(finding["substep"], 2);
  EXPECT_EQ(finding["body"], 1);
  EXPECT_EQ(finding["quantity"], "velocity");
  EXPECT_EQ(finding["unit"], "m/s");
  EXPECT_EQ(finding["before"], false);

  const Outcome again = run_headless({"run", "--load", saved_, "--executor", "cpu", "--guards", "pause",
                                      "--steps", "1", "--save", folder_ / "again.snapshot", "--json", "-"});
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.err, HasSubstr(line));
  EXPECT_EQ(json::parse(again.out)["guards"]["finding"], finding);
  EXPECT_EQ(json::parse(again.out)["state_hash"], report["state_hash"]);

  const Outcome off = run_headless(
      {"run", "--load", saved_, "--executor", "cpu", "--guards", "off", "--steps", "25", "--json", "-"});
  EXPECT_EQ(off.status, 0) << off.err;
  EXPECT_EQ(json::parse(off.out)["steps"], 40);
  EXPECT_FALSE(json::parse(off.out).contains("guards"));
}

TEST_F(FailingRun, SavesWhereItRunsAndOverwritesNothing) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  const std::vector<std::string> run{"run", scene_, "--executor", "cpu", "--steps", "40"};
  const Outcome first = run_headless(run), second = run_headless(run);
  fs::current_path(before);
  EXPECT_EQ(first.status, 1);
  EXPECT_THAT(first.err, HasSubstr("state 15 before the failure saved to failure-one_falls-16.snapshot\n"));
  EXPECT_THAT(second.err,
              HasSubstr("state 15 before the failure saved to failure-one_falls-16-2.snapshot\n"));
  EXPECT_EQ(read_snapshot(folder_ / "failure-one_falls-16.snapshot").state.steps, 15);
  EXPECT_TRUE(fs::exists(folder_ / "failure-one_falls-16-2.snapshot"));
}

TEST_F(FailingRun, SavesUnderANameOfItsOwnBesideOthers) {
  constexpr int runs = 12;
  const fs::path folder = folder_ / "runs", before = fs::current_path();
  fs::create_directory(folder);
  fs::current_path(folder);
  std::vector<pid_t> children;
  for (int k = 0; k < runs; ++k) {
    const pid_t child = fork();
    if (child == 0)
      become_program(headless_program(), {"run", scene_, "--executor", "cpu", "--steps", "40"}, {},
                     "/dev/null", "/dev/null");
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 1) << status;
  }
  fs::current_path(before);
  int snapshots = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    EXPECT_EQ(read_snapshot(entry.path()).state.steps, 15);
    ++snapshots;
  }
  EXPECT_EQ(snapshots, runs);
}

TEST_F(FailingRun, GoesOnWithTheBodyFrozen) {
  const Outcome frozen = run_headless({"run", scene_, "--executor", "cpu", "--guards", "freeze", "--steps",
                                       "40", "--save", saved_, "--json", "-"});
  EXPECT_EQ(frozen.status, 0) << frozen.err;
  EXPECT_THAT(frozen.err, HasSubstr("note: number of frozen bodies: 1; last finding: " + std::string(line)));
  const json report = json::parse(frozen.out);
  EXPECT_EQ(report["steps"], 40);
  EXPECT_EQ(report["guards"]["frozen"], json::array({1}));
  EXPECT_EQ(report["guards"]["finding"]["step"], 16);
  EXPECT_EQ(read_snapshot(saved_).state.frozen, std::vector<std::uint32_t>{1});
}

TEST_F(FailingRun, BreaksOnAConditionAndGoesBackAStep) {
  // The speed passes 5 m/s in the step to state 16, with and without guards.
  const Outcome broken = run_headless({"run", plain_, "--executor", "cpu", "--break", "non-finite,speed=5",
                                       "--steps", "40", "--save", saved_, "--json", "-"});
  EXPECT_EQ(broken.status, 1);
  EXPECT_THAT(
      broken.err,
      HasSubstr("speed: after step 16 5.232 m/s, over 5 m/s, body 1; state 15 before the failure saved to " +
                saved_));
  EXPECT_EQ(json::parse(broken.out)["steps"], 15);
  const Outcome again = run_headless({"run", "--load", saved_, "--executor", "cpu", "--break", "speed=5",
                                      "--steps", "1", "--save", folder_ / "again.snapshot"});
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.err, HasSubstr("speed: after step 16 5.232 m/s, over 5 m/s, body 1"));
  const Outcome whole =
      run_headless({"run", plain_, "--executor", "cpu", "--break", "speed=50,escaped", "--steps", "40"});
  EXPECT_EQ(whole.status, 0) << whole.err;
}

TEST_F(FailingRun, BreaksAtTheFirstState) {
  Scene scene;
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(20, 20, 20)};
  scene.bodies = {sphere(0.5, Vector3d(25, 5, 5))};
  write(plain_, scene);
  for (const char* steps : {"0", "5"}) {
    const Outcome broken = run_headless({"run", plain_, "--executor", "cpu", "--break", "escaped", "--steps",
                                         steps, "--save", saved_, "--json", "-"});
    EXPECT_EQ(broken.status, 1);
    EXPECT_EQ(broken.err,
              "escaped: at state 0 1 bodies, the first is body 0; state 0 saved to " + saved_ + "\n");
    EXPECT_EQ(json::parse(broken.out)["steps"], 0);
    EXPECT_EQ(read_snapshot(saved_).state.steps, 0);
  }
}

TEST_F(FailingRun, DoesNotTakeTheEnergyOfAChangeForAnError) {
  Scene scene;
  scene.physics.gravity = Vector3d(0, 0, 0);
  scene.bodies = {sphere(0.5, Vector3d(0, 0, 0), Vector3d(1, 0, 0))};
  write(plain_, scene);
  std::ofstream(folder_ / "changes.json") << R"({"format": "collidoscope-changes", "version": 1, "changes": [
{"step": 3, "add": [{"radius": 0.5, "position": [9, 0, 0], "velocity": [50, 0, 0]}]}]})";
  const Outcome run = run_headless({"run", plain_, "--executor", "cpu", "--break", "energy-rise=5", "--steps",
                                    "8", "--changes", folder_ / "changes.json"});
  EXPECT_EQ(run.status, 0) << run.err;
}

TEST_F(FailingRun, IsToldWhatTheFlagsTake) {
  const Outcome outcome = run_headless({"run", scene_, "--guards", "on", "--break", "sped,energy-rise=-1"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--guards: on is not pause, freeze or off\n"));
  EXPECT_THAT(outcome.err,
              HasSubstr("--break: 'sped' is not a condition; expected a list of non-finite, energy-rise=%"));
  EXPECT_THAT(outcome.err,
              HasSubstr("--break: 'energy-rise=-1': expected energy-rise=%, a number from 0 to 1e+09\n"));
}

TEST_F(FailingRun, EndsACaptureToo) {
  const Outcome capture = run_headless({"capture", scene_, "--executor", "cpu", "--states", "2,20", "--size",
                                        "64x64", "--out", folder_ / "pictures"});
  EXPECT_EQ(capture.status, 1);
  EXPECT_THAT(capture.err, HasSubstr(line));
  EXPECT_TRUE(fs::exists(folder_ / "pictures/one_falls_0002.png"));
}

}  // namespace
}  // namespace collidoscope
