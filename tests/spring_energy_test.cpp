// Tests that undamped springs keep the energy, wherever their anchors are.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/executors.h"
#include "tests/impact_scenes.h"

namespace collidoscope {
namespace {

class SpringEnergy : public OnEachExecutor {};
ON_EACH_EXECUTOR(SpringEnergy);

/// Up to three tumbling bodies with springs to the world and to each other. Anchors are up to two radii from
/// the centres.
Scene any_springs(Uniform& uniform) {
  Scene scene = impact_space(0);
  scene.physics.precision = Precision::f64;
  const int count = 1 + static_cast<int>(uniform.random() % 3);
  for (int k = 0; k < count; ++k) {
    Body& body =
        scene.bodies.emplace_back(ball(uniform(0.5, 2), 0.3, Vector3d(3 * k, 0, 0), uniform.vector(1)));
    body.angular_velocity = uniform.vector(2);
    const double side = 0.4 * *body.mass * 0.09;
    body.inertia = Vector3d(side, side * uniform(0.8, 1.2), side * uniform(0.8, 1.2));
    Joint joint;
    joint.kind = JointKind::spring;
    joint.a = k;
    joint.anchor_a = uniform.vector(0.35);
    joint.anchor_b = Vector3d(3 * k, 2, 0) + uniform.vector(0.5);
    if (k > 0 && uniform.random() % 2 == 0) {
      joint.b = k - 1;
      joint.anchor_b = uniform.vector(0.35);
    }
    joint.frequency = uniform(0.3, 2);
    joint.damping_ratio = 0;
    scene.joints.push_back(joint);
  }
  return scene;
}

/// Largest change of the energy in 4 s, relative to the largest kinetic energy.
double largest_change(Scene scene, int rate, const RunOptions& options) {
  scene.physics.time_step = TimeStep::per_second(rate);
  World world(scene, options);
  const double start = world.measure().energy();
  double change = 0, kinetic = 0;
  for (int step = 0; step < 4 * rate; ++step) {
    world.step();
    const StepStats now = world.measure();
    change = std::max(change, std::abs(now.energy() - start));
    kinetic = std::max(kinetic, now.kinetic_energy);
  }
  return change / kinetic;
}

TEST_P(SpringEnergy, IsKeptAtTheOrderOfTheIntegrator) {
  for (int seed = 0; seed < 12; ++seed) {
    Uniform uniform{Random(static_cast<std::uint32_t>(seed))};
    const Scene scene = any_springs(uniform);
    const double coarse = largest_change(scene, 60, options()), fine = largest_change(scene, 240, options());
    EXPECT_LT(coarse, 0.2) << seed;
    EXPECT_LT(fine, 0.4 * coarse + 1e-6) << seed;
  }
}

/// The stiffness of a spring is that at time zero, when the spring pulls through the centre of the body.
TEST_P(SpringEnergy, OfATurnedBodyIsThatOfItsStretch) {
  Scene scene = impact_space(0);
  scene.physics.precision = Precision::f64;
  scene.bodies = {ball(2, 0.5, Vector3d(2, 0, 0))};
  scene.bodies[0].angular_velocity = Vector3d(0, 0, 1);
  Joint joint;
  joint.kind = JointKind::spring;
  joint.a = 0;
  joint.anchor_a = Vector3d(0, 0.5, 0);
  joint.anchor_b = Vector3d(2, -20, 0);
  joint.frequency = 0.01;
  joint.damping_ratio = 0;
  scene.joints = {joint};
  World world(scene, options());
  world.step(47);  // about a quarter of a turn
  const BodyStates now = world.bodies();
  const Vector3d anchor = now.position[0] + now.orientation[0] * joint.anchor_a;
  const double stretch = (anchor - *joint.anchor_b).norm() - 20.5;
  const double angular_frequency = 2 * std::numbers::pi * joint.frequency;
  ASSERT_GT(std::abs(stretch), 0.3);
  EXPECT_NEAR(world.measure().potential_energy,
              2 * angular_frequency * angular_frequency * stretch * stretch / 2, 1e-9);
}

}  // namespace
}  // namespace collidoscope
