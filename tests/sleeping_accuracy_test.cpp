// Tests that bodies which sleep are where they would be without sleep.

#include <gtest/gtest.h>

#include "tests/executors.h"
#include "tests/sleeping_scenes.h"

namespace collidoscope {
namespace {

class SleepersAccuracy : public OnEachExecutor {};
ON_EACH_EXECUTOR(SleepersAccuracy);

/// The largest distance of a body of one world from the same body of another, m.
double distance_between(World& a, World& b) {
  const BodyStates left = a.bodies(), right = b.bodies();
  double largest = 0;
  for (std::size_t i = 0; i < left.position.size(); ++i)
    largest = std::max(largest, (left.position[i] - right.position[i]).norm());
  return largest;
}

Scene ball_rolls_into(Scene scene, const Vector3d& place, double speed) {
  scene.bodies.push_back(sphere(1, place, Vector3d(speed, 0, 0)));
  scene.bodies.back().angular_velocity = Vector3d(0, speed, 0);
  return scene;
}

/// Until they wake, bodies are at most 10 um from those of a run that never slept. After the blow of a ball,
/// the difference is at most ten times that of another run that never slept, from a start that differs by
/// 0.1 um, in float by the spacing of positions, 4 um.
TEST_P(SleepersAccuracy, AreWhereTheyWouldBeWithoutSleep) {
  struct Case {
    Scene scene;
    int sleepers, blow, last;  // bodies that sleep; states
  };
  for (const Case& each :
       {Case{ball_rolls_into(sleeping_columns({0, 2, 4, 6}, 1), Vector3d(-24, 0, 1), 6), 4, 110, 340},
        Case{ball_rolls_into(sleeping_columns({0, 2, 4, 6}, 1), Vector3d(-40, 0.3, 1), 6), 4, 190, 340},
        Case{ball_rolls_into(sleeping_columns({0, 2, 4}, 2), Vector3d(-40, 0.3, 1), 9), 6, 125, 180}})
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      Scene scene = each.scene;
      scene.physics.precision = precision;
      World slept(scene, options());
      scene.physics.sleep.reset();
      World never(scene, options());
      double sign = precision == Precision::f32 ? 4e-6 : 1e-7;
      for (Body& body : scene.bodies) body.position.x() += sign *= -1;
      World moved(scene, options());
      int asleep = 0;
      double largest = 0;  // of the moved run
      for (int step = 1; step <= each.last; ++step) {
        for (World* world : {&slept, &never, &moved}) world->step();
        if (step == each.blow - 20) asleep = count_asleep(slept);
        largest = std::max(largest, distance_between(moved, never));
        ASSERT_LE(distance_between(slept, never), step < each.blow ? 1e-5 : 10 * largest)
            << "state " << step << ", " << each.sleepers << " sleepers, blow at " << each.blow;
      }
      EXPECT_EQ(asleep, each.sleepers);
      EXPECT_LT(count_asleep(slept), each.sleepers) << "the blow woke them";
    }
}

/// Whole piles. The distance comes from balls that fall asleep while others still move, so it differs from
/// pile to pile: of eleven, the median is 9 um, the largest value 150 um. In float, the pile that never
/// sleeps creeps: positions are multiples of 4 um there.
TEST_P(SleepersAccuracy, APileIsWhereItWouldBeWithoutSleep) {
  std::vector<double> distances;
  for (const int count : {460, 500, 540}) {
    Scene scene = project_scene("pile");
    scene.generators[0].count = count;
    scene.materials[0].rolling_resistance = 0.05;
    scene.physics.precision = Precision::f64;
    scene.physics.sleep = Sleep{};
    World slept(scene, options());
    scene.physics.sleep.reset();
    World never(scene, options());
    double largest = 0;
    for (int step = 100; step <= 700; step += 100) {
      slept.step(100);
      never.step(100);
      largest = std::max(largest, distance_between(slept, never));
    }
    EXPECT_EQ(count_asleep(slept), count);
    EXPECT_LE(largest, 5e-4) << count;
    distances.push_back(largest);
  }
  std::ranges::nth_element(distances, distances.begin() + 1);
  EXPECT_LE(distances[1], 1e-4);
}

TEST_P(SleepersAccuracy, ABlowGoesThroughASleepingRow) {
  Scene scene = ball_rolls_into(sleeping_columns({0, 2, 4, 6}, 1), Vector3d(-24, 0, 1), 6);
  scene.materials[0].friction = 0.1;
  World world(scene, options());
  world.step(90);
  ASSERT_EQ(count_asleep(world, 0, 4), 4);
  EXPECT_EQ(count_asleep(world, 4), 0);
  world.step(50);  // the impact is at state 110
  EXPECT_EQ(count_asleep(world), 0);
  EXPECT_NEAR(world.bodies().velocity[3].x(), 0.959, 0.02) << "limit for small steps";
}

}  // namespace
}  // namespace collidoscope
