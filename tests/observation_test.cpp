// Tests the data that an observation keeps from earlier states, against values by hand.

#include "sim_cuda/stability/observation.h"

#include <gtest/gtest.h>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Observations : public OnEachExecutor {};
ON_EACH_EXECUTOR(Observations);

std::vector<Assertion> assertions_of(std::initializer_list<Quantity> quantities) {
  std::vector<Assertion> assertions;
  for (const Quantity quantity : quantities) assertions.emplace_back().quantity = quantity;
  return assertions;
}

TEST_P(Observations, RememberWhereBodiesWere) {
  Scene scene = hard_space();
  scene.physics.time_step = 0.125;
  scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(1, 0, 0))};
  World world(scene, options());
  std::vector<Assertion> assertions = assertions_of({Quantity::displacement, Quantity::displacement});
  assertions[1].since = 2;
  Observation observation(world, assertions);
  for (int state = 1; state <= 4; ++state) {
    world.step();
    observation.update(world, state * 0.125);
  }
  EXPECT_EQ(observation.seconds(), 0.5);
  EXPECT_NEAR(observation.bodies_since(0).position[0].x(), 0, 1e-12);
  EXPECT_NEAR(observation.bodies_since(2).position[0].x(), 0.25, 1e-12);
  EXPECT_NEAR(observation.bodies().position[0].x(), 0.5, 1e-12);
  EXPECT_NEAR(observation.bodies_since(3).position[0].x(), 0.5, 1e-12) << "nobody asked for this one";
}

TEST_P(Observations, ScalesAreTheLargestSoFar) {
  Scene scene = hard_space(Vector3d(0, 0, -10));
  scene.physics.time_step = 0.125;
  scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(0, 0, 2.5))};
  scene.bodies[0].mass = 2;
  World world(scene, options());
  Observation observation(world, assertions_of({Quantity::energy_gain, Quantity::momentum_change}));
  EXPECT_DOUBLE_EQ(observation.energy_scale(), 6.25);
  EXPECT_DOUBLE_EQ(observation.momentum_scale(), 5);
  world.step(2);  // at the highest point
  observation.update(world, 0.25);
  EXPECT_DOUBLE_EQ(observation.momentum_scale(), 5);
  EXPECT_GE(observation.energy_scale(), 6.0);
  world.step(6);
  observation.update(world, 1);
  EXPECT_NEAR(observation.momentum_scale(), 15, 1e-9);
}

TEST_P(Observations, KnowWhoOverlappedAtFirst) {
  Scene scene = hard_space();
  scene.bodies = {sphere(1, Vector3d(0, 0, 0)), sphere(1, Vector3d(1, 0, 0)), sphere(1, Vector3d(5, 0, 0))};
  World world(scene, options());
  Observation observation(world, assertions_of({Quantity::separation_speed}));
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> wanted{{0, 1}};
  EXPECT_EQ(observation.overlapping(), wanted);
}

TEST_P(Observations, OverlapsAreOfPairsWallsAndBoxes) {
  Scene scene = hard_space();
  scene.bodies = {sphere(1, Vector3d(0, 0, 0)), sphere(0.5, Vector3d(1.25, 0, 0)),
                  sphere(1, Vector3d(0, 5.5, 0)), sphere(1, Vector3d(0, -5.5, 0))};
  scene.obstacles.push_back({Vector3d(0, -1, 0), -6, 0});  // y <= 6
  scene.boxes.push_back({Vector3d(0, -7, 0), Vector3d(2, 2, 2), Quaterniond(1, 0, 0, 0), 0});
  World world(scene, options());
  const std::vector<Overlap> found = overlaps(world, world.bodies());
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].body, 0u);
  EXPECT_EQ(found[0].other, 1u);
  EXPECT_DOUBLE_EQ(found[0].depth, 0.25);
  EXPECT_EQ(found[0].radius, 0.5);
  EXPECT_EQ(found[1].body, 2u);
  EXPECT_FALSE(found[1].other);
  EXPECT_DOUBLE_EQ(found[1].depth, 0.5);
  EXPECT_EQ(found[2].body, 3u);
  EXPECT_DOUBLE_EQ(found[2].depth, 0.5);
}

}  // namespace
}  // namespace collidoscope
