// Tests that the run of a hard case steps like any other run, including its changes and injected faults.

#include "sim_cuda/stability/hard_case_simulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class HardRuns : public OnEachExecutor {};
ON_EACH_EXECUTOR(HardRuns);

TEST_P(HardRuns, IsTheRunThatRunMakes) {
  const Scene scene = box_collider(50);
  World world(scene, options());
  world.step(20);
  HardCaseSimulation run(scene, options());
  for (int k = 0; k < 20; ++k) run.step();
  EXPECT_EQ(run.state(), 20);
  EXPECT_NEAR(run.seconds(), 20 * scene.physics.time_step, 1e-12);
  EXPECT_EQ(run.world().state_hash(), world.state_hash());
}

TEST_P(HardRuns, MakesChangesAtTheirStates) {
  Change begin, later;
  begin.step = 0;
  begin.settings.set<&Physics::time_step>(0.25);
  later.step = 2;
  later.settings.set<&Physics::time_step>(0.5);
  later.add = {sphere(1, Vector3d(9, 9, 9))};
  Scene scene = empty_space();
  scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(1, 0, 0))};
  HardCaseSimulation run(scene, options(), {begin, later});
  run.step();
  EXPECT_EQ(run.world().initial().size(), 1u);
  run.step();
  EXPECT_EQ(run.world().initial().size(), 2u) << "at the state, before the step that leads on";
  run.step();
  EXPECT_EQ(run.seconds(), 1);
  EXPECT_NEAR(run.world().bodies().position[0].x(), 1, 1e-6);
}

TEST_P(HardRuns, PlantsWhatItIsTold) {
  Scene scene = empty_space();
  scene.bodies = {sphere(1, Vector3d(0, 0, 0)), sphere(1, Vector3d(9, 0, 0))};
  InjectedState injected;
  injected.step = 3;
  injected.body = 1;
  injected.position = Vector3d(5, std::nan(""), 0);
  HardCaseSimulation run(scene, options(), {}, injected);
  run.step();
  run.step();
  EXPECT_TRUE(run.world().bodies().position[1].allFinite());
  run.step();
  const BodyStates bodies = run.world().bodies();
  EXPECT_EQ(bodies.position[1].x(), 5);
  EXPECT_TRUE(std::isnan(bodies.position[1].y()));
  EXPECT_TRUE(bodies.velocity[1].allFinite() && bodies.position[0].allFinite());
}

}  // namespace
}  // namespace collidoscope
