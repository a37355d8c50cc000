// Tests kinematic and static bodies: they move others and are not moved, against closed forms. Also tests
// their counts, and that scenes without them pay no cost.

#include <cmath>

#include "tests/executors.h"
#include "tests/gravity.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Prescribed : public testing::TestWithParam<std::tuple<ExecutorKind, Solver>> {
 protected:
  RunOptions options() const {
    RunOptions o;
    o.executor = std::get<0>(GetParam());
    return o;
  }
  Scene space() const {
    Scene scene = empty_space();
    scene.physics.solver = std::get<1>(GetParam());
    scene.physics.precision = Precision::f64;
    scene.physics.time_step = 1.0 / 120;
    return scene;
  }
};
INSTANTIATE_TEST_SUITE_P(Executors, Prescribed,
                         testing::Combine(testing::ValuesIn(executors()),
                                          testing::Values(Solver::impulse, Solver::soft_step)),
                         [](const auto& each) {
                           return std::string(std::get<0>(each.param) == ExecutorKind::cuda ? "cuda"
                                                                                            : "cpu") +
                                  (std::get<1>(each.param) == Solver::impulse ? "_impulse" : "_soft_step");
                         });

Body with_motion(Body body, Motion motion) {
  body.motion = motion;
  return body;
}

TEST_P(Prescribed, NothingStopsAKinematicBody) {
  Scene scene = space();
  scene.physics.gravity = Vector3d(0, 0, -g);
  scene.physics.drag.density = 1000;
  scene.box = Box{Vector3d(-5, -5, -5), Vector3d(5, 5, 5)};
  scene.obstacles = {Plane{Vector3d(0, -1, 0), -2, 0}};
  scene.bodies = {with_motion(sphere(0.5, Vector3d(0, 0, 0), Vector3d(8, 3, -1)), Motion::kinematic),
                  sphere(0.4, Vector3d(1.5, 0, 0)), sphere(0.4, Vector3d(-2, -2, -3)),
                  with_motion(sphere(1, Vector3d(-1, -3, -3)), Motion::fixed)};
  scene.bodies[0].angular_velocity = Vector3d(1, 2, 3);
  World world(scene, options());
  for (int k = 1; k <= 120; ++k) {
    world.step();
    const BodyStates s = world.bodies();
    EXPECT_NEAR((s.position[0] - k / 120.0 * scene.bodies[0].velocity).norm(), 0, 1e-12) << k;
    EXPECT_EQ(s.velocity[0], scene.bodies[0].velocity) << k;
    EXPECT_EQ(s.angular_velocity[0], scene.bodies[0].angular_velocity) << k;
    EXPECT_EQ(s.position[3], scene.bodies[3].position) << k;
    EXPECT_EQ(s.velocity[3], Vector3d(0, 0, 0)) << k;
    const StepStats stats = world.measure();
    EXPECT_EQ(stats.non_finite, 0);
    EXPECT_EQ(stats.escaped, 0) << "of those whom walls should hold";
    EXPECT_LT(stats.max_penetration, 0.1);
  }
  const double parts = 120.0 * substeps_in_effect(scene.physics);
  const double turn = parts * 2 * std::atan(std::sqrt(14.0) / parts / 2);  // angle of Cayley's update
  EXPECT_NEAR(std::abs(world.bodies().orientation[0].w()), std::abs(std::cos(turn / 2)), 1e-9);
}

TEST_P(Prescribed, ABounceOffOneIsThatOffAWallThatMoves) {
  for (const double wall : {-3.0, 0.0, 2.0}) {
    Scene scene = space();
    const Motion motion = wall == 0 ? Motion::fixed : Motion::kinematic;
    scene.bodies = {with_motion(sphere(1, Vector3d(0, 0, 0), Vector3d(0, wall, 0)), motion),
                    sphere(0.5, Vector3d(0, 1.6, 0), Vector3d(0, -5, 0))};
    World world(scene, options());
    world.records().record_impulses(true);
    double given = 0;
    for (int k = 0; k < 60; ++k) {
      world.step();
      for (const ContactImpulse& contact : world.records().impulses()) given += contact.impulse;
    }
    EXPECT_NEAR(world.bodies().velocity[1].y(), 2 * wall + 5, 1e-9);
    EXPECT_NEAR(given, world.initial().mass[1] * (2 * wall + 10), 1e-9 * given) << "all that it gained";
    EXPECT_NEAR(world.measure().momentum[1], world.initial().mass[1] * (2 * wall + 5), 1e-6)
        << "momentum is that of what forces move";
    EXPECT_NEAR(world.measure().kinetic_energy, world.initial().mass[1] * std::pow(2 * wall + 5, 2) / 2,
                1e-5);
  }
}

TEST_P(Prescribed, MassAndInertiaDoNotMatter) {
  std::uint64_t hash[2];
  for (int heavy = 0; heavy < 2; ++heavy) {
    Scene scene = space();
    scene.physics.precision = Precision::f32;
    scene.physics.gravity = Vector3d(0, 0, -g);
    scene.box = Box{Vector3d(-4, -4, 0), Vector3d(4, 4, 20)};
    if (std::get<1>(GetParam()) == Solver::soft_step) scene.materials[0].friction = 0.4;
    scene.materials[0].restitution = 0.3;
    scene.bodies = {with_motion(sphere(2, Vector3d(0, 0, 2.5)), Motion::fixed),
                    with_motion(sphere(1, Vector3d(2, 2, 1), Vector3d(-0.5, 0, 0)), Motion::kinematic)};
    for (int k = 0; k < 40; ++k)
      scene.bodies.push_back(sphere(0.4, Vector3d(k % 3 - 1.0, k / 3 % 3 - 1.0, 5.5 + k / 9)));
    if (heavy) {
      scene.bodies[0].mass = 1e20;
      scene.bodies[1].mass = 1e-6;
      scene.bodies[0].inertia = Vector3d(1, 2, 3);
    }
    World world(scene, options());
    world.step(120);
    hash[heavy] = world.state_hash();
    EXPECT_EQ(world.measure().non_finite, 0);
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST_P(Prescribed, TwoOfThemHaveNoContact) {
  Scene scene = space();
  scene.bodies = {with_motion(sphere(1, Vector3d(0, 0, 0)), Motion::fixed),
                  with_motion(sphere(1, Vector3d(1, 0, 0)), Motion::fixed),
                  with_motion(sphere(1, Vector3d(-5, 0, 0), Vector3d(4, 0, 0)), Motion::kinematic),
                  sphere(0.5, Vector3d(0, 0, 1.5))};
  World world(scene, options());
  for (int k = 0; k < 120; ++k) {
    world.step();
    EXPECT_LE(world.measure().speculative, 3);
    EXPECT_EQ(world.measure().non_finite, 0);
  }
  EXPECT_GT(world.pairs().size(), 1u) << "boxes overlap all the same";
  EXPECT_EQ(world.bodies().velocity[2], Vector3d(4, 0, 0));
}

TEST_P(Prescribed, WhatIsNotCalledForCostsNothing) {
  Scene plain = box_collider(300), one = plain;
  plain.physics.solver = one.physics.solver = std::get<1>(GetParam());
  plain.bodies = {sphere(1, Vector3d(50, 50, 50))};
  one.bodies = {with_motion(plain.bodies[0], Motion::fixed)};
  World a(plain, options()), b(one, options());
  const auto launches = [](World& world) {
    world.step(10);
    int sum = 0;
    for (const StageTime& stage : world.times().stages) sum += stage.launches;
    return sum;
  };
  EXPECT_EQ(launches(b) - launches(a), plain.physics.solver == Solver::impulse ? 2 : 2 + 2 * 4);
  EXPECT_EQ(b.info().allocated_bytes - a.info().allocated_bytes, 4 + 2 * 12)
      << "an id, a position, a velocity";
}

class PrescribedSoftly : public OnEachExecutor {
 protected:
  Scene space() const {
    Scene scene = empty_space();
    scene.physics.solver = Solver::soft_step;
    scene.physics.precision = Precision::f64;
    scene.physics.time_step = 1.0 / 120;
    scene.physics.gravity = Vector3d(0, 0, -g);
    scene.materials[0].restitution = 0;
    return scene;
  }
};
ON_EACH_EXECUTOR(PrescribedSoftly);

TEST_P(PrescribedSoftly, AnElevatorCarriesABall) {
  Scene scene = space();
  scene.bodies = {with_motion(sphere(2, Vector3d(0, 0, -2), Vector3d(0, 0, 1.5)), Motion::kinematic),
                  sphere(0.5, Vector3d(0, 0, 0.5))};
  World world(scene, options());
  world.records().record_impulses(true);
  world.step(120);
  double given = 0;
  for (int k = 0; k < 60; ++k) {
    world.step();
    for (const ContactImpulse& contact : world.records().impulses()) given += contact.impulse;
  }
  const BodyStates s = world.bodies();
  EXPECT_NEAR(s.velocity[1].z(), 1.5, 1e-6);
  const double omega = 3.14159265358979323846 / 2 * 480;
  EXPECT_NEAR(s.position[1].z() - s.position[0].z(), 2.5, 1.1 * g / omega / omega)
      << "it yields by m g/(m w^2)";
  EXPECT_NEAR(given, world.initial().mass[1] * g * 0.5, 1e-3 * given) << "and bears the weight";
}

TEST_P(PrescribedSoftly, ASpinningOneDragsWhatItTouches) {
  Scene scene = space();
  scene.materials[0].friction = 0.3;
  scene.bodies = {with_motion(sphere(2, Vector3d(0, 0, -2)), Motion::kinematic),
                  sphere(0.5, Vector3d(0, 0, 0.5))};
  scene.bodies[0].angular_velocity = Vector3d(0, 10, 0);
  World world(scene, options());
  world.step(4);
  const BodyStates s = world.bodies();
  EXPECT_NEAR(s.velocity[1].x(), 0.3 * g * 4 / 120, 0.02 * 0.3 * g * 4 / 120) << "mu g t, while it slips";
  EXPECT_EQ(s.angular_velocity[0], Vector3d(0, 10, 0));
}

TEST_P(PrescribedSoftly, AStaticSphereBearsAPile) {
  // Spheres in a tube of four planes above a sphere that fills the tube. That sphere carries their whole
  // weight.
  Scene scene = space();
  scene.materials.push_back(
      {.name = "rough", .restitution = 0, .friction = 0.5});  // used by the spheres of the pile
  for (const double side : {1.0, -1.0}) {
    scene.obstacles.push_back(Plane{Vector3d(side, 0, 0), -1, 0});
    scene.obstacles.push_back(Plane{Vector3d(0, side, 0), -1, 0});
  }
  scene.bodies = {with_motion(sphere(1.4, Vector3d(0, 0, 0)), Motion::fixed)};
  Random random(5);
  for (int k = 0; k < 60; ++k)
    scene.bodies.push_back(sphere(0.3, Vector3d(k % 2 - 0.5, k / 2 % 2 - 0.5, 2 + 0.7 * (k / 4)) +
                                           1e-8 * Vector3d(random() % 999999, random() % 999999, 0)));
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) scene.bodies[i].material = 1;
  World world(scene, options());
  world.records().record_impulses(true);
  world.step(3600);
  double up = 0, weight = 0;
  const int steps = 480;
  for (int k = 0; k < steps; ++k) {
    const BodyStates s = world.bodies();
    world.step();
    for (const ContactImpulse& contact : world.records().impulses())
      if (contact.a == 0) up += contact.impulse * (s.position[contact.b] - s.position[0]).normalized().z();
  }
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) weight += world.initial().mass[i] * g;
  EXPECT_NEAR(up, weight * steps / 120, 0.01 * weight * steps / 120);
  EXPECT_LT(world.measure().max_penetration, 0.03);
  EXPECT_EQ(world.bodies().position[0], Vector3d(0, 0, 0));
}

}  // namespace
}  // namespace collidoscope
