// Tests drag against closed forms: terminal speeds, the tanh law and exponential decay. Also tests that drag
// never reverses a velocity, misses no contact, and costs nothing where it is not required.

#include <cmath>
#include <numbers>

#include "tests/executors.h"
#include "tests/gravity.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Dragging : public testing::TestWithParam<std::tuple<ExecutorKind, Solver>> {
 protected:
  RunOptions options() const {
    RunOptions o;
    o.executor = std::get<0>(GetParam());
    return o;
  }
  /// One sphere in a medium.
  Scene in_medium(double viscosity, double density, const Vector3d& gravity, const Vector3d& velocity) const {
    Scene scene = empty_space();
    scene.physics.solver = std::get<1>(GetParam());
    scene.physics.precision = Precision::f64;
    scene.physics.gravity = gravity;
    scene.physics.drag = {.viscosity = viscosity, .density = density};
    scene.bodies = {sphere(0.05, Vector3d(0, 0, 0), velocity)};
    scene.bodies[0].mass = 1.5;
    return scene;
  }
};
INSTANTIATE_TEST_SUITE_P(Executors, Dragging,
                         testing::Combine(testing::ValuesIn(executors()),
                                          testing::Values(Solver::impulse, Solver::soft_step)),
                         [](const auto& each) {
                           return std::string(std::get<0>(each.param) == ExecutorKind::cuda ? "cuda"
                                                                                            : "cpu") +
                                  (std::get<1>(each.param) == Solver::impulse ? "_impulse" : "_soft_step");
                         });

constexpr double radius = 0.05, mass = 1.5, drag_coefficient = 0.47;
double linear_rate(double viscosity) { return 6 * std::numbers::pi * viscosity * radius / mass; }
double quadratic_rate(double density) {
  return density * drag_coefficient * std::numbers::pi * radius * radius / 2 / mass;
}

TEST_P(Dragging, TheTerminalSpeedIsExactForEveryTimeStep) {
  for (const auto& [viscosity, density] : {std::pair(3.0, 0.0), {0.0, 1000.0}, {3.0, 800.0}, {1000.0, 0.0}})
    for (const double dt : {1.0 / 240, 1.0 / 30, 1.0, 100.0})
      for (const auto& [precision, integrator] : {std::pair(Precision::f32, Integrator::semi_implicit_euler),
                                                  {Precision::f64, Integrator::semi_implicit_euler},
                                                  {Precision::f32, Integrator::velocity_verlet},
                                                  {Precision::f64, Integrator::velocity_verlet},
                                                  {Precision::f32, Integrator::rk4},
                                                  {Precision::f64, Integrator::rk4}}) {
        Scene scene = in_medium(viscosity, density, Vector3d(0.6 * g, 0, -0.8 * g), Vector3d(0, 0, 0));
        scene.physics.time_step = dt;
        scene.physics.integrator = integrator;
        scene.physics.precision = precision;
        const double a = linear_rate(viscosity), b = quadratic_rate(density);
        const double speed = 2 * g / (a + std::sqrt(a * a + 4 * b * g));  // a v + b v^2 = g
        World world(scene, options());
        world.step(static_cast<int>(60 + 40 / (dt * (a + b * speed))));
        const Vector3d v = world.bodies().velocity[0];
        // Each substep rounds the velocity changes of gravity and drag. The relative drag per substep
        // determines how far these errors accumulate.
        const double h = dt / substeps_in_effect(scene.physics),
                     bit = precision == Precision::f64 ? 2e-16 : 1e-7;
        const double near = bit * (4 * g * h + 4 * speed / std::min(1.0, h * (a + b * speed)));
        EXPECT_NEAR(v.x(), 0.6 * speed, near) << viscosity << ' ' << density << ' ' << dt;
        EXPECT_NEAR(v.z(), -0.8 * speed, near) << viscosity << ' ' << density << ' ' << dt;
      }
}

TEST_P(Dragging, FallsByTheTanhLaw) {
  const double density = 1000, end = 1, terminal = std::sqrt(g / quadratic_rate(density));
  for (const Integrator integrator : {Integrator::semi_implicit_euler, Integrator::velocity_verlet}) {
    double error[2];
    for (int fine = 0; fine < 2; ++fine) {
      Scene scene = in_medium(0, density, Vector3d(0, 0, -g), Vector3d(0, 0, 0));
      scene.physics.integrator = integrator;
      const int steps = 240 << fine;
      scene.physics.time_step = TimeStep::per_second(steps);
      scene.physics.substeps = 1;
      World world(scene, options());
      world.step(steps);
      const BodyStates s = world.bodies();
      error[fine] = -s.velocity[0].z() - terminal * std::tanh(g * end / terminal);
      // Euler: h/2 max |v''| t, |v''| <= 4/(3 sqrt 3) g^2 / v_t
      EXPECT_LE(std::abs(error[fine]), 0.5 / steps * 0.77 * g * g / terminal * end);
      EXPECT_NEAR(-s.position[0].z(), terminal * terminal / g * std::log(std::cosh(g * end / terminal)),
                  g * end / steps);
    }
    const bool euler = integrator == Integrator::semi_implicit_euler;
    EXPECT_NEAR(error[0] / error[1], euler ? 2 : 4, 0.05) << "first order, or second";
  }
}

TEST_P(Dragging, SlowMotionDiesOutExponentiallyFastMotionAsOneOverT) {
  const Vector3d start(3, -4, 12);
  for (const bool fast : {false, true}) {
    const double viscosity = fast ? 0 : 2, density = fast ? 50 : 0;
    const int steps = 600;
    Scene scene = in_medium(viscosity, density, Vector3d(0, 0, 0), start);
    scene.physics.integrator = Integrator::semi_implicit_euler;
    scene.physics.time_step = TimeStep::per_second(steps);
    scene.physics.substeps = 1;
    World world(scene, options());
    world.step(steps);
    const double k = fast ? quadratic_rate(density) * start.norm() : linear_rate(viscosity), h = 1.0 / steps;
    const double left = fast ? 1 / (1 + k) : std::exp(-k);
    const Vector3d v = world.bodies().velocity[0];
    EXPECT_NEAR((v - left * start).norm(), 0, k * k * h * start.norm()) << "h/2 max |v''| t";
    const double of_euler = fast ? v.norm() / start.norm() : std::pow(1 + k * h, -steps);
    EXPECT_NEAR((v - of_euler * start).norm(), 0, 1e-12);
    EXPECT_LT(v.cross(start).norm(), 1e-12 * v.norm() * start.norm()) << "straight on";
  }
}

TEST_P(Dragging, NeverTurnsABodyRound) {
  for (const double much : {1.0, 1e3, 1e6, 1e9})
    for (const double dt : {1e-9, 1.0 / 30, 1e3})
      for (const Precision precision : {Precision::f32, Precision::f64}) {
        Scene scene = in_medium(much, much, Vector3d(0, 0, 0), Vector3d(1000, 0, 0));
        scene.physics.time_step = dt;
        scene.physics.precision = precision;
        scene.bodies[0].mass = 1e-30;
        World world(scene, options());
        double last = 1000;
        for (int k = 0; k < 3; ++k) {
          world.step();
          const Vector3d v = world.bodies().velocity[0];
          EXPECT_GE(v.x(), 0);
          EXPECT_LE(v.x(), last);
          last = v.x();
        }
        EXPECT_EQ(world.measure().non_finite, 0);
      }
}

TEST_P(Dragging, BetweenBouncesEnergyOnlyFalls) {
  Scene scene = in_medium(0.5, 20, Vector3d(0, 0, -g), Vector3d(0, 0, -3));
  scene.bodies[0].position.z() = 2;
  scene.obstacles = {Plane{}};
  World world(scene, options());
  double last = world.measure().energy();
  for (int k = 0; k < 200; ++k) {
    world.step();
    const StepStats stats = world.measure();
    EXPECT_LE(stats.energy() - stats.push_work, last * (1 + 1e-12)) << k;
    EXPECT_LT(stats.max_penetration, 1e-9);
    last = stats.energy() - stats.push_work;
  }
  EXPECT_LT(last, mass * g * 0.5);
}

TEST_P(Dragging, WhatIsNotCalledForCostsNothing) {
  Scene plain = box_collider(300);
  plain.physics.solver = std::get<1>(GetParam());
  Scene left_out = plain, wet = plain, no_sphere = plain;
  wet.physics.drag.density = left_out.physics.drag.density = no_sphere.physics.drag.density = 2;
  no_sphere.physics.drag.coefficient = 0;
  left_out.physics.effects = Effects{.gravity = true};
  World a(plain, options()), b(left_out, options()), c(wet, options()), d(no_sphere, options());
  EXPECT_FALSE(a.effects().drag);
  EXPECT_TRUE(c.effects().drag);
  EXPECT_FALSE(d.effects().drag);
  auto expected = launches_by_stage(a);
  EXPECT_EQ(launches_by_stage(b), expected);
  expected["drag"] = substeps_in_effect(plain.physics);
  EXPECT_EQ(launches_by_stage(c), expected);
  EXPECT_EQ(a.info().allocated_bytes, b.info().allocated_bytes);
  EXPECT_EQ(a.info().allocated_bytes, c.info().allocated_bytes) << "a stage, and not a byte";
  EXPECT_EQ(a.state_hash(), b.state_hash());
  d.step(10);
  EXPECT_EQ(a.state_hash(), d.state_hash());
  EXPECT_NE(a.state_hash(), c.state_hash());
}

TEST_P(Dragging, NoRoundingTurnsABodyRound) {
  // The remaining speed is far below the rounding error of a float.
  for (const Integrator integrator :
       {Integrator::semi_implicit_euler, Integrator::velocity_verlet, Integrator::rk4})
    for (const double viscosity : {1e2, 1e4, 1e6, 1e8})
      for (const double speed : {1.0, 70.0, 100.0, 900.0}) {
        Scene scene = in_medium(viscosity, 1e6, Vector3d(0, 0, 0), Vector3d(speed, 0, 0));
        scene.physics.precision = Precision::f32;
        scene.physics.integrator = integrator;
        scene.bodies = {sphere(0.01, Vector3d(0, 0, 0), Vector3d(speed, 0, 0)),
                        sphere(0.03, Vector3d(0, 1, 0), Vector3d(speed, 0, 0))};
        World world(scene, options());
        for (int k = 0; k < 3; ++k) {
          world.step();
          for (const Vector3d& v : world.bodies().velocity) EXPECT_GE(v.x(), 0) << viscosity << ' ' << speed;
          for (const Vector3d& x : world.bodies().position) EXPECT_GE(x.x(), 0) << viscosity << ' ' << speed;
        }
      }
}

class DragAndContacts : public OnEachExecutor {};
ON_EACH_EXECUTOR(DragAndContacts);

TEST_P(DragAndContacts, NobodyPassesThroughWhatTheMediumStops) {
  // Two bodies move side by side at one speed. Air stops the light one and not the heavy one, so only the
  // drag lets them collide.
  for (const int order : {0, 1}) {
    Scene scene = empty_space();
    scene.physics.solver = Solver::soft_step;
    scene.physics.precision = Precision::f64;
    scene.physics.drag.density = 1000;
    scene.materials[0].restitution = 0;
    scene.bodies = {sphere(0.1, Vector3d(0, 0, 0), Vector3d(30, 0, 0)),
                    sphere(0.1, Vector3d(0.25, 0, 0), Vector3d(30, 0, 0))};
    scene.bodies[0].mass = 1000;
    scene.bodies[1].mass = 1;
    if (order == 1) std::swap(scene.bodies[0], scene.bodies[1]);
    World world(scene, options());
    for (int k = 0; k < 20; ++k) {
      world.step();
      const BodyStates s = world.bodies();
      const double steel = s.position[static_cast<std::size_t>(order)].x();
      const double foam = s.position[static_cast<std::size_t>(1 - order)].x();
      EXPECT_GT(foam - steel, 0.1) << k
                                   << ": pressed by the drag of half a tonne of water, it yields a little";
    }
  }
}

}  // namespace
}  // namespace collidoscope
