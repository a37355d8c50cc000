// Tests loops of joints with known answers and default settings: motions that a loop does not change, rings
// that rotate, nets that hang, and contradictions.

#include <cmath>
#include <numbers>

#include "tests/energy_scenes.h"
#include "tests/executors.h"
#include "tests/joint_scenes.h"

namespace collidoscope {
namespace {

class JointLoopRuns : public OnEachExecutor {
 protected:
  BodyStates after(const Scene& scene, double seconds) {
    World world(scene, options());
    world.step(static_cast<int>(std::lround(seconds / scene.physics.time_step)));
    return world.bodies();
  }
};
ON_EACH_EXECUTOR(JointLoopRuns);

Scene free_space(int rate, double gravity) {
  Scene scene = impact_space(0, gravity);
  scene.physics.precision = Precision::f64;
  scene.physics.time_step = TimeStep::per_second(rate);
  return scene;
}

Joint rod(std::int64_t a, std::int64_t b) { return joint_between(JointKind::distance, a, b); }

/// Balls on equal parallel arms, which a bar connects, swing like one ball.
TEST_P(JointLoopRuns, AParallelogramSwingsAsOnePendulum) {
  for (const int rate : {30, 120}) {
    const Vector3d arm(std::sin(1.0), 0, -std::cos(1.0));
    Scene one = free_space(rate, g);
    one.bodies = {ball(1, 0.1, arm)};
    one.joints = {joint_at(one, JointKind::distance, 0, std::nullopt, Vector3d(0, 0, 0))};
    Scene bar = one;
    for (int k = 1; k < 4; ++k) {
      const Vector3d from(2.0 * k, 0, 0);
      bar.bodies.push_back(ball(std::pow(10, k), 0.1, from + arm));
      bar.joints.push_back(joint_at(bar, JointKind::distance, k, std::nullopt, from));
      bar.joints.push_back(rod(k, k - 1));
    }
    const Vector3d single = after(one, 10).position[0];
    const BodyStates four = after(bar, 10);
    for (int k = 0; k < 4; ++k)
      EXPECT_LT((four.position[static_cast<std::size_t>(k)] - Vector3d(2.0 * k, 0, 0) - single).norm(), 1e-6)
          << rate << ' ' << k;
  }
}

/// Two hinges on one axis, with five redundant equations, do not change the motion.
TEST_P(JointLoopRuns, ASecondHingeOfADoorChangesNothing) {
  Scene door = free_space(60, g);
  door.bodies = {ball(3, 0.1, Vector3d(0.5, 0, 0))};
  door.bodies[0].inertia = Vector3d(0.3, 0.5, 0.25);
  door.joints = {joint_at(door, JointKind::hinge, 0, std::nullopt, Vector3d(0, 0, 0))};
  Scene twice = door;
  twice.joints.push_back(joint_at(twice, JointKind::hinge, 0, std::nullopt, Vector3d(0, 1, 0)));
  World world(twice, options());
  const double start = world.measure().energy();
  double change = 0;
  for (int k = 0; k < 600; ++k) {
    world.step();
    change = std::max(change, std::abs(world.measure().energy() - start));
  }
  EXPECT_LT(change, 1e-6 * 3 * g * 0.5);
  EXPECT_LT(world.measure().max_joint_error, 1e-9);
  EXPECT_LT((world.bodies().position[0] - after(door, 10).position[0]).norm(), 1e-6);
}

/// A ring of equal balls and rods keeps its shape, rotation and energy. The phase is exact to order 2.
TEST_P(JointLoopRuns, ARingRotates) {
  constexpr int balls = 12;
  constexpr double spin = 6;  // rad/s
  const auto direction = [](double angle) { return Vector3d(std::cos(angle), std::sin(angle), 0); };
  double errors[2];
  for (int k = 0; k < 2; ++k) {
    Scene ring = free_space(k == 0 ? 60 : 120, 0);
    for (int i = 0; i < balls; ++i) {
      const double angle = 2 * std::numbers::pi * i / balls;
      ring.bodies.push_back(ball(2, 0.05, direction(angle), spin * direction(angle + std::numbers::pi / 2)));
      if (i > 0) ring.joints.push_back(rod(i, i - 1));
    }
    ring.joints.push_back(rod(0, balls - 1));
    const BodyStates end = after(ring, 5);
    errors[k] = 0;
    for (int i = 0; i < balls; ++i) {
      const Vector3d place = end.position[static_cast<std::size_t>(i)];
      EXPECT_NEAR(place.norm(), 1, 1e-6) << i;
      EXPECT_NEAR(end.velocity[static_cast<std::size_t>(i)].norm(), spin, 1e-6) << i;
      errors[k] =
          std::max(errors[k], (place - direction(2 * std::numbers::pi * i / balls + 5 * spin)).norm());
    }
  }
  EXPECT_LT(errors[0], 0.02);
  EXPECT_NEAR(errors[0] / errors[1], 4, 0.2);
}

/// A chain between two supports, with a heavy link in the middle, comes to rest in two straight lines.
TEST_P(JointLoopRuns, AHeavyLoadHangsStraight) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Scene scene = free_space(60, g);
    scene.physics.precision = precision;
    scene.physics.drag.viscosity = 1000;  // the load loses its speed in 2.7 s
    constexpr int links = 20, middle = 9;
    for (int k = 0; k + 1 < links; ++k) {
      const double x = 0.1 * (k + 1), z = -0.05 * std::min(k + 1, links - 1 - k);
      scene.bodies.push_back(ball(k == middle ? 1000 : 0.1, 0.02, Vector3d(x, 0, z)));
      if (k > 0) scene.joints.push_back(rod(k, k - 1));
    }
    scene.joints.push_back(joint_at(scene, JointKind::distance, 0, std::nullopt, Vector3d(0, 0, 0)));
    scene.joints.push_back(joint_at(scene, JointKind::distance, links - 2, std::nullopt, Vector3d(2, 0, 0)));
    World world(scene, options());
    world.step(600);
    const double half = 10 * std::hypot(0.1, 0.05);
    EXPECT_LT(world.measure().max_joint_error, precision == Precision::f32 ? 2e-5 : 1e-6);
    EXPECT_NEAR(world.bodies().position[middle].z(), -std::sqrt(half * half - 1), 1e-3);
  }
}

/// Rods that cannot all be satisfied: bodies come to rest, and errors do not grow.
TEST_P(JointLoopRuns, ContradictionsComeToRest) {
  Scene scene = free_space(60, g);
  const Vector3d corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 0, -1}, {0, 0, -1}};
  for (const Vector3d& corner : corners) scene.bodies.push_back(ball(1, 0.1, corner));
  for (const auto& [a, b] : {std::pair(0, 1), {1, 2}, {2, 3}, {3, 0}, {0, 2}, {1, 3}})
    scene.joints.push_back(rod(a, b));
  scene.joints.back().length = 1.6;
  scene.joints.push_back(joint_at(scene, JointKind::ball, 0, std::nullopt, corners[0]));
  scene.joints.push_back(joint_at(scene, JointKind::ball, 1, std::nullopt, corners[1]));
  World world(scene, options());
  world.step(600);
  EXPECT_EQ(world.measure().non_finite, 0);
  EXPECT_LT(world.measure().max_joint_error, 0.2);
  EXPECT_LT(world.measure().max_speed, 0.05);
}

}  // namespace
}  // namespace collidoscope
