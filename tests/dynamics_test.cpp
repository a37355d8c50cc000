// Tests motion and impacts against formulas. The tolerances follow from the order of the method.

#include <cmath>
#include <numbers>

#include "sim_cuda/dynamics/rotation_updates.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Dynamics : public OnEachExecutor {};
ON_EACH_EXECUTOR(Dynamics);

TEST_P(Dynamics, FlightFollowsSemiImplicitEuler) {
  Scene scene = empty_space();
  scene.physics.precision = Precision::f64;
  scene.physics.gravity = Vector3d(0.5, 0, -9.81);
  scene.physics.substeps = 3;
  scene.bodies = {sphere(1, Vector3d(1, 2, 300), Vector3d(3, -1, 4))};
  World world(scene, options());
  const int steps = 90;
  world.step(steps);
  const double n = 3.0 * steps, h = scene.physics.time_step / 3, t = n * h;
  const Vector3d g = scene.physics.gravity;
  const Vector3d expected =
      scene.bodies[0].position + t * scene.bodies[0].velocity + h * h * n * (n + 1) / 2 * g;
  EXPECT_LT((world.bodies().position[0] - expected).norm(), 1e-11 * expected.norm());
  // The parabola is missed by h t g / 2, which is the bias of Euler's method.
  const Vector3d parabola = scene.bodies[0].position + t * scene.bodies[0].velocity + t * t / 2 * g;
  EXPECT_LT((world.bodies().position[0] - parabola - h * t / 2 * g).norm(), 1e-10);
}

/// Steps two spheres ten times, so that they collide; returns their velocities.
std::pair<Vector3d, Vector3d> impact(Scene scene, Body a, Body b, const RunOptions& options) {
  scene.physics.precision = Precision::f64;
  scene.bodies = {a, b};
  World world(scene, options);
  world.step(10);
  const BodyStates states = world.bodies();
  return {states.velocity[0], states.velocity[1]};
}

TEST_P(Dynamics, HeadOnImpactsFollowNewton) {
  for (const double e : {0.0, 0.3, 0.8, 1.0})
    for (const double mass : {1e-3, 1.0, 7.0, 1e6}) {
      Scene scene = empty_space();
      scene.materials[0].restitution = e;
      Body a = sphere(1, Vector3d(0, 0, 0), Vector3d(5, 0, 0)),
           b = sphere(0.5, Vector3d(2, 0, 0), Vector3d(-1, 0, 0));
      a.mass = 2;
      b.mass = mass;
      const auto [u, v] = impact(scene, a, b, options());
      const double center = (2 * 5 - mass) / (2 + mass), closing = 6;
      EXPECT_NEAR(u.x(), center - mass * e * closing / (2 + mass), 1e-12 * closing);
      EXPECT_NEAR(v.x(), center + 2 * e * closing / (2 + mass), 1e-12 * closing);
    }
}

TEST_P(Dynamics, ObliqueImpactsKeepTheTangentialPart) {
  Scene scene = empty_space();
  scene.materials[0].restitution = 0.6;
  const Body a = sphere(1, Vector3d(0, 0, 0), Vector3d(0, 0, 0)),
             b = sphere(1, Vector3d(1.9, 0.5, 0.2), Vector3d(-6, 0, 1));
  // The spheres overlap from the start, so the normal is that of the first step.
  const Vector3d n = (b.position - a.position).normalized();
  const auto [u, v] = impact(scene, a, b, options());
  const double closing = -b.velocity.dot(n), impulse = (1 + 0.6) * closing / 2;  // per mass, equal masses
  EXPECT_LT((u + impulse * n).norm(), 1e-12);
  EXPECT_LT((v - (b.velocity + impulse * n)).norm(), 1e-12);
}

TEST_P(Dynamics, SlowContactsDoNotBounce) {
  Scene scene = empty_space();
  scene.physics.restitution_threshold = 1.0;
  const Body a = sphere(1, Vector3d(0, 0, 0), Vector3d(0.9, 0, 0)), b = sphere(1, Vector3d(2, 0, 0));
  const auto [u, v] = impact(scene, a, b, options());
  EXPECT_NEAR(u.x(), 0.45, 1e-12);
  EXPECT_NEAR(v.x(), 0.45, 1e-12);
}

TEST_P(Dynamics, CoincidentCentresPartAlongZ) {
  Scene scene = empty_space();
  scene.physics.precision = Precision::f64;
  scene.bodies = {sphere(1, Vector3d(3, 4, 5)), sphere(1, Vector3d(3, 4, 5))};
  World world(scene, options());
  world.step(100);
  const BodyStates s = world.bodies();
  EXPECT_GT(s.position[1].z() - s.position[0].z(), 1.9);
  EXPECT_EQ(s.position[1].x(), 3);
  EXPECT_EQ(s.position[0].y(), 4);
  EXPECT_NEAR(s.position[0].z() + s.position[1].z(), 10, 1e-12);  // the centre of mass stays
}

TEST_P(Dynamics, MomentumIsBalancedByTheWalls) {
  // p(t) = p(0) + wall impulses + m g t
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Scene scene = box_collider(1000);
    scene.generators[0].speed_max = 30;
    scene.physics.precision = precision;
    World world(scene, options());
    const StepStats before = world.measure();
    double mass = 0, scale = 0;
    for (const double m : world.initial().mass) mass += m;
    world.step(120);
    const StepStats after = world.measure();
    const double t = 120 * scene.physics.time_step;
    scale = mass * 30;
    for (int k = 0; k < 3; ++k) {
      const double given = after.wall_impulse_vector[k] + mass * scene.physics.gravity[k] * t;
      EXPECT_NEAR(after.momentum[k] - before.momentum[k], given,
                  (precision == Precision::f32 ? 1e-5 : 1e-13) * scale);
    }
    EXPECT_GE(after.wall_impulse, std::abs(after.wall_impulse_vector[2]));
  }
}

TEST_P(Dynamics, ABodyAtRestOnTheFloorStaysAndWeighsMg) {
  Scene scene = empty_space();
  scene.physics.precision = Precision::f64;
  scene.physics.gravity = Vector3d(0, 0, -9.81);
  scene.box = Box{};
  scene.bodies = {sphere(1, Vector3d(50, 50, 1))};
  World world(scene, options());
  world.step(300);
  EXPECT_NEAR(world.bodies().position[0].z(), 1, 1e-12);
  EXPECT_NEAR(world.measure().wall_impulse, world.initial().mass[0] * 9.81 * 10,
              1e-9 * world.measure().wall_impulse);
}

TEST_P(Dynamics, FastBodiesNeverCrossAWall) {
  for (const auto& [precision, integrator] : {std::pair(Precision::f32, Integrator::semi_implicit_euler),
                                              {Precision::f64, Integrator::semi_implicit_euler},
                                              {Precision::f32, Integrator::velocity_verlet},
                                              {Precision::f64, Integrator::rk4}}) {
    Scene scene = empty_space();
    scene.physics.precision = precision;
    scene.physics.integrator = integrator;
    scene.physics.gravity = Vector3d(0, 0, -9.81);
    scene.box = Box{};
    Random random(1);
    for (int i = 0; i < 100; ++i) {
      const auto u = [&] { return random() / 4294967296.0; };
      scene.bodies.push_back(sphere(1e-6 + 0.5 * u() * u(),
                                    Vector3d(1 + 98 * u(), 1 + 98 * u(), 1 + 98 * u()),
                                    Vector3d(2e4 * (u() - 0.5), 2e4 * (u() - 0.5), 2e4 * (u() - 0.5))));
    }
    World world(scene, options());
    for (int k = 0; k < 100; ++k) {
      world.step();
      ASSERT_EQ(world.measure().escaped, 0);
    }
  }
}

TEST_P(Dynamics, ASlopeIsSlidDownWithoutFriction) {
  // The body starts at rest on a plane tilted by 30 degrees: a = g sin(30), so s = a t^2 / 2. Euler's method
  // misses it by h t a / 2.
  Scene scene = empty_space();
  scene.physics.precision = Precision::f64;
  scene.physics.gravity = Vector3d(0, 0, -9.81);
  const Vector3d normal(0.5, 0, std::sqrt(0.75)), down(std::sqrt(0.75), 0, -0.5);
  scene.obstacles = {Plane{normal, 0, 0}};
  scene.bodies = {sphere(1, normal)};
  World world(scene, options());
  world.step(60);
  const double t = 2, h = scene.physics.time_step, a = 9.81 / 2;
  EXPECT_NEAR((world.bodies().position[0] - normal).dot(down), a * t * (t + h) / 2, 1e-10);
  EXPECT_NEAR((world.bodies().position[0] - normal).dot(normal), 0, 1e-10);
}

// ---- rotation ----

struct Spin {
  Quaterniond q;
  Vector3d w;
};

Spin spun(Vector3d inertia, Vector3d w, double time, int steps) {
  Spin s{Quaterniond(1, 0, 0, 0), w};
  for (int k = 0; k < steps; ++k) rotate_first_order<double>(s.q, s.w, inertia, time / steps);
  return s;
}

Vector3d momentum(const Spin& s, const Vector3d& inertia) {
  return s.q * Vector3d(inertia.array() * (s.q.conjugate() * s.w).array());
}

TEST(Rotation, OfASymmetricTopPrecesses) {
  // Free precession: the body rotates about its own axis by (1 - I3/I1) w3 t, and about L by |L|/I1 t.
  const Vector3d inertia(2, 2, 1), w(0.5, 0, 3);
  const double time = 1.5;
  const Vector3d l0(inertia.array() * w.array());
  const Quaterniond about_l(Eigen::AngleAxisd(l0.norm() / 2 * time, l0.normalized()));
  const Quaterniond about_axis(Eigen::AngleAxisd((1 - 1.0 / 2) * w.z() * time, Vector3d(0, 0, 1)));
  const Quaterniond exact = about_l * about_axis;
  double errors[3];
  for (int k = 0; k < 3; ++k) {
    const Spin s = spun(inertia, w, time, 400 << k);
    errors[k] = s.q.angularDistance(exact);
    EXPECT_LT((momentum(s, inertia) - l0).norm(), 1e-12 * l0.norm());
    EXPECT_NEAR(s.q.norm(), 1, 1e-14);
  }
  EXPECT_LT(errors[0], 0.01);
  for (int k = 0; k < 2; ++k)
    EXPECT_NEAR(std::log2(errors[k] / errors[k + 1]), 1, 0.05) << "first order in h";
}

TEST(Rotation, AboutTheMiddleAxisTumblesAndKeepsAngularMomentum) {
  const Vector3d inertia(1, 2, 3), w(1e-3, 2, 0);
  Spin s{Quaterniond(1, 0, 0, 0), w};
  const Vector3d l0(inertia.array() * w.array());
  bool flipped = false;
  for (int k = 0; k < 20000; ++k) {
    rotate_first_order<double>(s.q, s.w, inertia, 1e-3);
    flipped = flipped || (s.q.conjugate() * s.w).y() < -1.9;
  }
  EXPECT_TRUE(flipped);
  EXPECT_LT((momentum(s, inertia) - l0).norm(), 1e-11 * l0.norm());
}

TEST_P(Dynamics, TheSpinningTopOfTheSceneKeepsItsAngularMomentum) {
  Scene scene = project_scene("spinning_top");
  scene.physics.precision = Precision::f64;
  World world(scene, options());
  ASSERT_TRUE(world.effects().rotation);
  const StepStats before = world.measure();
  world.step(300);
  const StepStats after = world.measure();
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(
        after.angular_momentum[k], before.angular_momentum[k],
        1e-11 * Vector3d(before.angular_momentum[0], before.angular_momentum[1], before.angular_momentum[2])
                    .norm());
}

TEST_P(Dynamics, AGyroscopePrecesses) {
  constexpr double g = 9.81;
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Scene scene = hard_space(Vector3d(0, 0, -g));
    scene.physics.precision = precision;
    const double arm = 0.1, spin = 200, time = 4;
    scene.bodies = {sphere(0.02, Vector3d(arm, 0, 0))};
    Body& disc = scene.bodies[0];
    disc.mass = 1;
    disc.inertia = Vector3d(0.006, 0.006, 0.01);
    disc.orientation = Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY()));
    disc.angular_velocity = Vector3d(spin, 0, 0);
    scene.joints.emplace_back();
    scene.joints[0].kind = JointKind::ball;
    scene.joints[0].anchor_a = Vector3d(0, 0, -arm);
    scene.joints[0].anchor_b = Vector3d(0, 0, 0);
    World world(scene, options());
    world.step(120);
    const BodyStates s = world.bodies();
    const Vector3d axis = s.orientation[0] * Vector3d::UnitZ(), w = s.angular_velocity[0];
    // Torque m g arm over I3 w3. A fast top oscillates slightly about that.
    EXPECT_NEAR(std::atan2(axis.y(), axis.x()), g * arm / (0.01 * spin) * time, 0.01);
    EXPECT_NEAR(axis.dot(w), spin, 0.01);
    EXPECT_NEAR(axis.z(), 0, 0.02);
  }
}

TEST_P(Dynamics, BallsRotateAlikeUnderBothRotationUpdates) {
  Scene scene = hard_space();
  scene.physics.effects = Effects{.rotation = true};
  for (int k = 0; k < 5; ++k) {
    scene.bodies.push_back(sphere(1, Vector3d(3 * k, 0, 0)));
    scene.bodies.back().angular_velocity = Vector3d(k, 1, 2);
  }
  const auto orientations = [&](RotationUpdate update, bool with_disc) {
    Scene changed = scene;
    changed.physics.rotation_update = update;
    if (with_disc) {
      changed.bodies.push_back(sphere(1, Vector3d(0, 9, 0)));
      changed.bodies.back().inertia = Vector3d(1, 1, 2);
    }
    World world(changed, options());
    world.step(50);
    std::vector<Quaterniond> q = world.bodies().orientation;
    q.resize(5);
    return q;
  };
  const auto expected = orientations(RotationUpdate::first_order, false);
  for (const RotationUpdate update : {RotationUpdate::first_order, RotationUpdate::lie_group})
    for (const bool with_disc : {false, true}) {
      const auto q = orientations(update, with_disc);
      for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(q[k].coeffs(), expected[k].coeffs());
    }
}

TEST_P(Dynamics, ASceneWithoutSpinStoresNone) {
  Scene still = box_collider(1000), spinning = still;
  spinning.physics.effects = Effects{.gravity = true, .rotation = true};
  World a(still, options()), b(spinning, options());
  EXPECT_FALSE(a.effects().rotation);
  // orientation 16, spin 16, inertia 12 bytes per body
  EXPECT_EQ(b.info().allocated_bytes - a.info().allocated_bytes, 1000 * 44);
  a.step(20);
  b.step(20);
  EXPECT_EQ(a.state_hash(), b.state_hash()) << "a spin of zero changes nothing";
}

}  // namespace
}  // namespace collidoscope
