// Tests rolling resistance against closed forms: stopping distances, inclines and the decay of spin. Also
// tests conservation laws, and that a scene without it pays no cost.

#include <cmath>

#include "tests/executors.h"
#include "tests/gravity.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

constexpr double r = 0.5;

class Resisting : public OnEachExecutor {};
ON_EACH_EXECUTOR(Resisting);

/// One sphere of 0.5 m in contact with a plane through the origin that descends along +x by `angle`.
Scene on_a_plane(double resistance, double angle) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = Precision::f64;
  scene.physics.gravity = Vector3d(0, 0, -g);
  scene.physics.time_step = 1.0 / 120;
  scene.materials[0] = {.restitution = 0, .friction = 2, .rolling_resistance = resistance};
  const Vector3d normal(std::sin(angle), 0, std::cos(angle));
  scene.obstacles = {Plane{normal, 0, 0}};
  scene.bodies = {sphere(r, r * normal)};
  return scene;
}

TEST_P(Resisting, ABallRollsOut) {
  for (const double c : {0.01, 0.05, 0.3}) {
    Scene scene = on_a_plane(c, 0);
    const double v0 = 4, h = scene.physics.time_step / 4, slowing = 5 * c * g / 7;
    scene.bodies[0].velocity = Vector3d(0.6 * v0, 0.8 * v0, 0);
    scene.bodies[0].angular_velocity = Vector3d(-0.8 * v0 / r, 0.6 * v0 / r, 0);
    World world(scene, options());
    const double stops = v0 / slowing;
    const int half = static_cast<int>(stops / 2 * 120);
    world.step(half / 2);
    const double before = world.bodies().velocity[0].norm();
    world.step(half - half / 2);
    const BodyStates s = world.bodies();
    EXPECT_NEAR(before - s.velocity[0].norm(), slowing * (half - half / 2) / 120.0, 1e-9) << "5/7 c g";
    // In the first few substeps the friction precedes the resistance, so the deceleration is not yet 5/7 of c
    // g.
    EXPECT_NEAR(s.velocity[0].norm(), v0 - slowing * half / 120.0, 4 * c * g * h) << c;
    EXPECT_NEAR(s.angular_velocity[0].norm() * r, s.velocity[0].norm(), 1e-9) << "it rolls";
    world.step(half + 240);
    const BodyStates end = world.bodies();
    EXPECT_LT(end.velocity[0].norm(), 1e-9);
    EXPECT_LT(end.angular_velocity[0].norm(), 1e-9);
    EXPECT_NEAR((end.position[0] - scene.bodies[0].position).norm(), v0 * v0 / (2 * slowing),
                stops * 5 * c * g * h);
    EXPECT_NEAR(end.position[0].y() / end.position[0].x(), 0.8 / 0.6, 1e-9) << "straight on";
  }
}

/// The principal axis along the way has the moment 1e-3 I or 1.9 I, the others I.
TEST_P(Resisting, ABallOfUnequalMomentsRollsOut) {
  const double v0 = 2, c = 0.1, moment = 0.1, slowing = c * g * r * r / (moment + r * r);
  for (const double along : {1e-3, 1.9}) {
    Scene scene = on_a_plane(c, 0);
    scene.bodies[0].velocity = Vector3d(v0, 0, 0);
    scene.bodies[0].angular_velocity = Vector3d(0, v0 / r, 0);
    scene.bodies[0].mass = 1;
    scene.bodies[0].inertia = moment * Vector3d(along, 1, 1);
    World world(scene, options());
    world.step(60);
    const double before = world.bodies().velocity[0].x();
    world.step(60);
    const BodyStates s = world.bodies();
    EXPECT_NEAR(before - s.velocity[0].x(), slowing / 2, 1e-9) << "of 0.5 s; " << along;
    EXPECT_NEAR(s.angular_velocity[0].y() * r, s.velocity[0].x(), 1e-9) << along;
    world.step(360);
    EXPECT_LT(world.bodies().velocity[0].norm(), 1e-9) << along;
  }
}

TEST_P(Resisting, AnInclineHoldsOrRolls) {
  for (const double degrees : {2.0, 10.0, 30.0})
    for (const double part : {0.5, 0.95, 1.05, 2.0}) {
      const double angle = degrees * 3.14159265358979323846 / 180, c = part * std::tan(angle);
      Scene scene = on_a_plane(c, angle);
      const double h = scene.physics.time_step / 4;
      World world(scene, options());
      const BodyStates start = world.bodies();
      world.step(120);
      const BodyStates s = world.bodies();
      const Vector3d down(std::cos(angle), 0, -std::sin(angle));
      if (part > 1) {
        EXPECT_LT((s.position[0] - start.position[0]).norm(), 20 * h * h * g)
            << "until friction has found its measure";
        EXPECT_LT(s.velocity[0].norm(), 1e-9) << degrees << ' ' << part;
        world.step(1200);
        EXPECT_LT((world.bodies().position[0] - s.position[0]).norm(), 1e-9) << "it does not creep";
      } else {
        const double a = 5.0 / 7 * g * (std::sin(angle) - c * std::cos(angle));
        EXPECT_NEAR(s.velocity[0].dot(down), a, 10 * g * std::sin(angle) * h) << degrees << ' ' << part;
        EXPECT_NEAR(s.angular_velocity[0].y() * r, s.velocity[0].dot(down), 1e-9);
      }
    }
}

TEST_P(Resisting, DrillingDiesOutAsWell) {
  const double c = 0.1, spin = 20, h = 1.0 / 480;
  Scene scene = on_a_plane(c, 0);
  scene.bodies[0].angular_velocity = Vector3d(0, 0, spin);
  World world(scene, options());
  world.step(120);
  EXPECT_NEAR(world.bodies().angular_velocity[0].z(), spin - 5 * c * g / (2 * r), 3 * c * g * h / r);
}

TEST_P(Resisting, APairTakesTheLargerAndThePartOfItsRadii) {
  // An attractor presses two spheres together, which spin in opposite directions.
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = Precision::f64;
  scene.physics.time_step = 1.0 / 120;
  scene.physics.attractors = {{.strength = 20, .softening = 1}};
  scene.materials[0] = {.restitution = 0, .rolling_resistance = 0.02};
  scene.materials.push_back({.name = "soft", .restitution = 0, .rolling_resistance = 0.1});
  scene.bodies = {sphere(r, Vector3d(-r, 0, 0)), sphere(r, Vector3d(r, 0, 0))};
  scene.bodies[1].material = 1;
  scene.bodies[0].angular_velocity = Vector3d(0, 3, 0);
  scene.bodies[1].angular_velocity = Vector3d(0, -1, 0);
  World world(scene, options());
  world.step(60);
  const BodyStates s = world.bodies();
  const double force = 20 * r / std::pow(r * r + 1, 1.5);  // per kilogram
  const double slowing = 0.1 * (r / 2) * force / (0.4 * r * r);
  EXPECT_NEAR(s.angular_velocity[0].y(), 3 - slowing * 0.5, 0.02 * slowing * 0.5);
  EXPECT_NEAR(s.angular_velocity[1].y(), -1 + slowing * 0.5, 0.02 * slowing * 0.5);
}

TEST_P(Resisting, BetweenBodiesKeepsMomentaAndLosesEnergy) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = Precision::f64;
  scene.materials[0] = {.restitution = 0.3, .friction = 0.6, .rolling_resistance = 0.4};
  Random random(7);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z) {
        const Vector3d place(2.3 * x + uniform(-0.1, 0.1), 2.3 * y + uniform(-0.1, 0.1),
                             2.3 * z + uniform(-0.1, 0.1));
        scene.bodies.push_back(sphere(uniform(0.4, 1), place, -1.5 * place));
        scene.bodies.back().angular_velocity = Vector3d(uniform(-5, 5), uniform(-5, 5), uniform(-5, 5));
      }
  World world(scene, options());
  const StepStats before = world.measure();
  double scale = 0, last = before.energy();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    scale += world.initial().mass[i] * (scene.bodies[i].velocity.norm() + 1);
  for (int step = 0; step < 40; ++step) {
    world.step();
    const StepStats now = world.measure();
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(now.momentum[k], before.momentum[k], 1e-13 * scale) << step;
      EXPECT_NEAR(now.angular_momentum[k], before.angular_momentum[k], 1e-12 * scale) << step;
    }
    EXPECT_LE(now.energy(), last * (1 + 1e-12)) << step;
    last = now.energy();
  }
}

TEST_P(Resisting, IsRemembered) {
  Scene scene = box_collider(300);
  scene.generators[0].radius_max = 9;
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = 0.5;
  scene.materials[0].rolling_resistance = 0.1;
  World plain(scene, options()), first(scene, options()), second(scene, options());
  plain.step(60);
  ASSERT_GT(plain.measure().speculative, 50);
  first.step(45);
  second.step(3);
  second.restore(first);
  second.step(15);
  EXPECT_EQ(second.state_hash(), plain.state_hash()) << "by another world";
  RunOptions tight = options();
  tight.initial_pair_capacity = 10;
  World grown(scene, tight);
  grown.step(60);
  EXPECT_EQ(grown.state_hash(), plain.state_hash()) << "when its lists grow";
}

TEST_P(Resisting, WhatIsNotCalledForCostsNothing) {
  Scene rough = box_collider(300);
  rough.physics.solver = Solver::soft_step;
  rough.materials[0].friction = 0.5;
  Scene left_out = rough, on = rough;
  on.materials[0].rolling_resistance = left_out.materials[0].rolling_resistance = 0.1;
  left_out.physics.effects = Effects{.gravity = true, .rotation = true, .friction = true};
  World a(rough, options()), b(left_out, options()), c(on, options());
  EXPECT_FALSE(a.effects().rolling_resistance);
  EXPECT_TRUE(c.effects().rolling_resistance);
  auto expected = launches_by_stage(a);
  EXPECT_EQ(launches_by_stage(b), expected);
  expected["rolling"] = 4 * 3;
  ++expected["prepare"];
  ++expected["keep"];
  EXPECT_EQ(launches_by_stage(c), expected);
  EXPECT_EQ(a.info().allocated_bytes, b.info().allocated_bytes);
  EXPECT_GT(c.info().allocated_bytes, a.info().allocated_bytes);
  EXPECT_EQ(a.state_hash(), b.state_hash());
  EXPECT_NE(a.state_hash(), c.state_hash());
}

}  // namespace
}  // namespace collidoscope
