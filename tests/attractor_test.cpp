// Tests attractors against closed forms: circular orbits, the oscillation about a softened centre, escape
// speeds and the potential energy. Also tests contacts that arise from the attraction alone.

#include <cmath>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

constexpr double pi = 3.14159265358979323846;

class Attracted : public OnEachExecutor {};
ON_EACH_EXECUTOR(Attracted);

/// One small sphere, and one attractor at the origin.
Scene pulled(double strength, double softening, const Vector3d& position, const Vector3d& velocity) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = Precision::f64;
  scene.physics.attractors = {{.strength = strength, .softening = softening}};
  scene.physics.substeps = 1;
  scene.bodies = {sphere(0.1, position, velocity)};
  return scene;
}

TEST_P(Attracted, ACircularOrbitHasItsPeriodAndEnergy) {
  for (const double softening : {0.1, 2.0}) {
    const bool kepler = softening < 1;
    const double mu = 1000, r = 10, squared = r * r + softening * softening;
    const double omega = std::sqrt(mu / squared / std::sqrt(squared)), period = 2 * pi / omega;
    double miss[2];
    for (int fine = 0; fine < 2; ++fine) {
      const int steps = 500 << fine;
      Scene scene = pulled(mu, softening, Vector3d(r, 0, 0), Vector3d(0, 0.6 * omega * r, 0.8 * omega * r));
      scene.physics.integrator = Integrator::semi_implicit_euler;
      scene.physics.time_step = period / steps;
      World world(scene, options());
      const StepStats first = world.measure();
      const double m = world.initial().mass[0], turn = omega * period / steps;
      EXPECT_NEAR(first.potential_energy, -m * mu / std::sqrt(squared), 1e-12 * m * mu);
      EXPECT_NEAR(first.kinetic_energy, m * omega * omega * r * r / 2, 1e-12 * m * mu);
      for (int k = 0; k < 4; ++k) {
        world.step(steps / 4);
        const BodyStates s = world.bodies();
        const StepStats stats = world.measure();
        // Symplectic Euler is of first order in the position (an orbit of eccentricity omega h / 2) and of
        // second order in energy and period.
        EXPECT_NEAR(s.position[0].norm(), r, turn * r);
        EXPECT_NEAR(stats.energy(), first.energy(), turn * turn * std::abs(first.energy()));
        EXPECT_NEAR(
            (s.position[0].cross(s.velocity[0]) * m - Vector3d(0, -0.8, 0.6) * m * omega * r * r).norm(), 0,
            1e-11 * m * omega * r * r)
            << "angular momentum";
      }
      miss[fine] = (world.bodies().position[0] - Vector3d(r, 0, 0)).norm();
      EXPECT_LT(miss[fine], kepler ? 2 * pi * turn * turn * r : turn * r);
    }
    // A softened orbit precesses, because it is not exactly a circle.
    EXPECT_NEAR(miss[0] / miss[1], kepler ? 4 : 2, 0.1) << "of second order where it closes";
  }
}

TEST_P(Attracted, ASoftenedCentreIsASpring) {
  const double mu = 50, eps = 2, omega = std::sqrt(mu / (eps * eps * eps)), period = 2 * pi / omega;
  Scene scene = pulled(mu, eps, Vector3d(0, 0, 0), Vector3d(0, 0, 0));
  World at_the_centre(scene, options());
  at_the_centre.step(100);
  EXPECT_EQ(at_the_centre.bodies().position[0], Vector3d(0, 0, 0));

  const double x0 = 1e-3 * eps;
  scene.bodies[0].position = Vector3d(0, x0, 0);
  scene.physics.time_step = period / 2000;
  World world(scene, options());
  const double h = omega * period / 2000;
  for (int k = 1; k <= 8; ++k) {
    world.step(250);
    // The phase error is of first order. Softening adds a relative deviation of 1.5 (x0/eps)^2 from a linear
    // spring.
    EXPECT_NEAR(world.bodies().position[0].y(), x0 * std::cos(k * pi / 4), x0 * h);
  }
}

TEST_P(Attracted, PullsAddUpAndARepellerLetsGoAtItsSpeed) {
  Scene scene = pulled(-200, 0.5, Vector3d(3, 0, 4), Vector3d(0, 0, 0));
  scene.physics.integrator = Integrator::semi_implicit_euler;
  scene.physics.time_step = 1e-3;
  World world(scene, options());
  const StepStats first = world.measure();
  world.step(20000);
  const StepStats last = world.measure();
  EXPECT_NEAR(last.energy(), first.energy(), 1e-3 * first.energy()) << "first order";
  const double m = world.initial().mass[0], far = world.bodies().position[0].norm();
  const double speed = std::sqrt(2 * 200 * (1 / std::sqrt(25.25) - 1 / far));
  EXPECT_NEAR(std::sqrt(2 * last.kinetic_energy / m), speed, 1e-3 * speed);

  // Two equal attractors cancel halfway between them. Gravity is added to both.
  Scene two = pulled(100, 1, Vector3d(0, 0, 0), Vector3d(0, 0, 0));
  two.physics.attractors = {{Vector3d(-5, 0, 0), 100, 1}, {Vector3d(5, 0, 0), 100, 1}};
  two.physics.integrator = Integrator::semi_implicit_euler;
  two.physics.gravity = Vector3d(0, 0, -3);
  two.physics.time_step = 1e-3;
  World between(two, options());
  between.step();
  const Vector3d v = between.bodies().velocity[0];
  EXPECT_EQ(v.x(), 0);
  EXPECT_NEAR(v.z(), -3e-3, 1e-15);
}

TEST_P(Attracted, BouncesKeepTheirHeight) {
  // The attractor is far below, so its field is almost uniform. Scene gravity is zero.
  Scene scene = pulled(9.81 * 1e6, 10, Vector3d(0, 0, 5), Vector3d(0, 0, 0));
  scene.physics.attractors[0].position = Vector3d(0, 0, -1000);
  scene.physics.time_step = 1.0 / 120;
  scene.physics.substeps = 4;
  scene.obstacles = {Plane{}};
  World world(scene, options());
  const double m = world.initial().mass[0], first = world.measure().energy();
  double highest = 0;
  for (int k = 0; k < 120 * 20; ++k) {
    world.step();
    ASSERT_LE(world.measure().energy(), first + 1e-9 * std::abs(first)) << k;
    if (k > 120 * 18) highest = std::max(highest, world.bodies().position[0].z());
  }
  EXPECT_GT(highest, 4.5) << "ten bounces, and Euler's drift";
  EXPECT_GT(world.measure().energy(), first - 0.1 * m * 9.81 * 5);
}

TEST_P(Attracted, BouncesLoseWhatTheRestitutionTakes) {
  // As above, at three step lengths. The largest field, at the attractor, is 4,000 times that at the floor.
  const double mu = 9.81 * 1e6, eps = 10, e = 0.8;
  const auto potential = [&](double z) { return -mu / std::sqrt((z + 1000) * (z + 1000) + eps * eps); };
  for (const int rate : {30, 120, 480}) {
    Scene scene = pulled(mu, eps, Vector3d(0, 0, 5), Vector3d(0, 0, 0));
    scene.materials[0].restitution = e;
    scene.physics.attractors[0].position = Vector3d(0, 0, -1000);
    scene.physics.time_step = 1.0 / rate;
    scene.physics.substeps = 4;
    scene.obstacles = {Plane{}};
    World world(scene, options());
    const double m = world.initial().mass[0], drop = potential(5) - potential(0.1);
    // Falls for 1 s, then flies for 1.6, 1.28 and 1.02 s.
    const double times[] = {1.8, 3.2, 4.4};
    for (int bounces = 1; bounces <= 3; ++bounces) {
      world.step(static_cast<int>(times[bounces - 1] * rate) - static_cast<int>(world.steps()));
      const double left = world.measure().energy() / m - potential(0.1);
      EXPECT_NEAR(left, std::pow(e * e, bounces) * drop, 1e-5 * drop) << rate << ' ' << bounces;
    }
  }
}

TEST_P(Attracted, WhatThePullBringsTogetherDoesNotPass) {
  Scene scene = pulled(1000, 0.5, Vector3d(-1, 0, 0), Vector3d(0, 0, 0));
  scene.bodies.push_back(sphere(0.1, Vector3d(1, 0, 0)));
  scene.materials[0].restitution = 0;
  scene.physics.time_step = 1.0 / 10;
  scene.physics.substeps = 64;
  World world(scene, options());
  for (int k = 0; k < 50; ++k) {
    world.step();
    const BodyStates s = world.bodies();
    EXPECT_GT(s.position[1].x() - s.position[0].x(), 0.19) << k;
  }
  EXPECT_LT(world.bodies().position[1].x(), 0.2);
}

TEST_P(Attracted, WhatIsNotCalledForCostsNothing) {
  Scene plain = box_collider(300);
  plain.physics.solver = Solver::soft_step;
  Scene left_out = plain, on = plain;
  on.physics.attractors = left_out.physics.attractors = {{Vector3d(50, 50, 50), 1e4, 10}};
  left_out.physics.effects = Effects{.gravity = true};
  World a(plain, options()), b(left_out, options()), c(on, options());
  EXPECT_FALSE(a.effects().attractor);
  EXPECT_TRUE(c.effects().attractor);
  auto expected = launches_by_stage(a);
  EXPECT_EQ(launches_by_stage(b), expected);
  expected["attractor"] = 4;
  EXPECT_EQ(launches_by_stage(c), expected);
  EXPECT_EQ(a.info().allocated_bytes, b.info().allocated_bytes);
  EXPECT_GT(c.info().allocated_bytes, a.info().allocated_bytes);
  EXPECT_EQ(a.state_hash(), b.state_hash());
  EXPECT_NE(a.state_hash(), c.state_hash());
}

}  // namespace
}  // namespace collidoscope
