// Tests friction against closed forms: sliding and rolling, inclines, stopping distances and spinning
// bounces. Also tests conservation laws, and that a scene without friction pays no cost.

#include <cmath>
#include <map>

#include "tests/executors.h"
#include "tests/gravity.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Rubbing : public OnEachExecutor {
 protected:
  /// Steps and returns the resulting states.
  BodyStates after(World& world, int steps) {
    world.step(steps);
    return world.bodies();
  }
};
ON_EACH_EXECUTOR(Rubbing);

/// One sphere of 0.5 m in contact with a plane through the origin that descends along +x by `angle`.
Scene on_a_plane(double mu, double angle) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = Precision::f64;
  scene.physics.gravity = Vector3d(0, 0, -g);
  scene.physics.time_step = 1.0 / 120;
  scene.materials[0].restitution = 0;
  scene.materials[0].friction = mu;
  const Vector3d normal(std::sin(angle), 0, std::cos(angle));
  scene.obstacles = {Plane{normal, 0, 0}};
  scene.bodies = {sphere(0.5, 0.5 * normal)};
  return scene;
}

TEST_P(Rubbing, SlidingTurnsToRolling) {
  for (const double mu : {0.1, 0.3, 0.8}) {
    Scene scene = on_a_plane(mu, 0);
    const double v0 = 7, r = 0.5, dt = scene.physics.time_step, h = dt / 4;
    scene.bodies[0].velocity = Vector3d(v0, 0, 0);
    World world(scene, options());
    const double rolling_at = 2 * v0 / (7 * mu * g);
    double seen_at = 0;
    for (int k = 1; k <= 400 && seen_at == 0; ++k) {
      const BodyStates s = after(world, 1);
      const double v = s.velocity[0].x(), spin = s.angular_velocity[0].y(), t = k * dt;
      if (t < rolling_at - h) {
        EXPECT_NEAR(v, v0 - mu * g * t, 1e-9 * v0);
        EXPECT_NEAR(spin, 5 * mu * g * t / (2 * r), 1e-9 * v0 / r);
      }
      if (std::abs(v - spin * r) < 1e-9) seen_at = t;
    }
    EXPECT_NEAR(seen_at, rolling_at, dt) << "2 v / (7 mu g)";
    const BodyStates s = after(world, 60);
    EXPECT_NEAR(s.velocity[0].x(), 5 * v0 / 7, 1e-9 * v0) << "the angular momentum about the floor is kept";
    EXPECT_NEAR(s.angular_velocity[0].y() * r, 5 * v0 / 7, 1e-9 * v0);
    EXPECT_NEAR(s.position[0].z(), r, 1e-9);
  }
}

/// The principal axis along the slip has the moment 1e-3 I, I or 1.9 I, the others I. The ball turns about
/// one of the others.
TEST_P(Rubbing, SlidingTurnsToRollingWithUnequalMoments) {
  const double v0 = 2, r = 0.5, mu = 0.5, moment = 0.1;
  for (const Precision precision : {Precision::f64, Precision::f32})
    for (const double along : {1e-3, 1.0, 1.9}) {
      Scene scene = on_a_plane(mu, 0);
      scene.physics.precision = precision;
      scene.bodies[0].velocity = Vector3d(v0, 0, 0);
      scene.bodies[0].mass = 1;
      scene.bodies[0].inertia = moment * Vector3d(along, 1, 1);
      World world(scene, options());
      const double tolerance = precision == Precision::f64 ? 1e-9 : 1e-5, dt = scene.physics.time_step;
      const BodyStates sliding = after(world, 10);
      EXPECT_NEAR(sliding.velocity[0].x(), v0 - mu * g * 10 * dt, tolerance * v0) << along;
      EXPECT_NEAR(sliding.angular_velocity[0].y(), mu * g * r / moment * 10 * dt, tolerance * v0 / r)
          << along;
      const BodyStates rolling = after(world, 110);
      EXPECT_NEAR(rolling.velocity[0].x(), v0 * r * r / (moment + r * r), tolerance * v0) << along;
      EXPECT_NEAR(rolling.angular_velocity[0].y() * r, rolling.velocity[0].x(), tolerance * v0) << along;
    }
}

TEST_P(Rubbing, AnInclineRollsOrSlides) {
  for (const double degrees : {10.0, 30.0, 50.0})
    for (const double part : {0.5, 0.95, 1.05, 2.0}) {
      const double angle = degrees * 3.14159265358979323846 / 180, r = 0.5;
      const double mu = part * 2 / 7 * std::tan(angle);  // with a factor below 1 the ball slides
      Scene scene = on_a_plane(mu, angle);
      World world(scene, options());
      const BodyStates start = world.bodies(), s = after(world, 120);
      const Vector3d down(std::cos(angle), 0, -std::sin(angle));
      const double pull = g * std::sin(angle), press = g * std::cos(angle), h = scene.physics.time_step / 4;
      const double a = part > 1 ? pull * 5 / 7 : pull - mu * press;
      const double turning = part > 1 ? a / r : 5 * mu * press / (2 * r);
      EXPECT_NEAR(s.velocity[0].dot(down), a, 1e-9 * g) << degrees << ' ' << part;
      EXPECT_NEAR(s.angular_velocity[0].y(), turning, 1e-9 * g / r) << degrees << ' ' << part;
      // Euler is ahead by h t a / 2. In the first substep the motion precedes the friction.
      EXPECT_NEAR((s.position[0] - start.position[0]).dot(down), a * (1 + h) / 2, h * h * g);
    }
}

TEST_P(Rubbing, WhatDoesNotTurnStopsAfterItsDistanceOrStays) {
  // With this moment of inertia the sphere behaves like a sliding block.
  Scene scene = on_a_plane(0.4, 0);
  const double v0 = 6, h = scene.physics.time_step / 4;
  scene.bodies[0].mass = 3;
  scene.bodies[0].inertia = Vector3d(1e12, 1e12, 1e12);
  scene.bodies[0].velocity = Vector3d(v0 * 0.6, v0 * 0.8, 0);
  World world(scene, options());
  const BodyStates s = after(world, 360);
  const double distance = v0 * v0 / (2 * 0.4 * g);
  EXPECT_NEAR(s.position[0].x(), 0.6 * distance, v0 * h);
  EXPECT_NEAR(s.position[0].y(), 0.8 * distance, v0 * h) << "as a vector: straight on";
  EXPECT_LT(s.velocity[0].norm(), 1e-9);

  const double angle = 0.3;
  Scene slope = on_a_plane(1.05 * std::tan(angle), angle);
  slope.bodies[0].mass = 3;
  slope.bodies[0].inertia = Vector3d(1e12, 1e12, 1e12);
  World held(slope, options());
  const Vector3d start = held.bodies().position[0];
  EXPECT_LT((after(held, 1200).position[0] - start).norm(), h * h * g) << "it does not creep";
}

TEST_P(Rubbing, ASpinningBounceTakesWhatTheWholeImpulseAllows) {
  for (const double mu : {0.05, 0.2, 1.0})
    for (const double e : {0.0, 0.5, 0.9}) {
      Scene scene = on_a_plane(mu, 0);
      scene.materials[0].restitution = e;
      const double r = 0.5, spin = 20, speed = 4, dt = scene.physics.time_step;
      scene.bodies[0].position.z() = r + 0.0123;
      scene.bodies[0].velocity = Vector3d(0, 0, -speed);
      scene.bodies[0].angular_velocity = Vector3d(0, spin, 0);
      World world(scene, options());
      const BodyStates s = after(world, 1);
      const double met = std::sqrt(speed * speed + 2 * g * 0.0123);
      const double expected = std::min(2 * r * spin / 7, mu * (1 + e) * met);
      // The body is on the parabola of an impact at the floor.
      const double v = s.velocity[0].z();
      EXPECT_NEAR(std::sqrt(v * v + 2 * g * (s.position[0].z() - r)), e * met, 1e-9) << mu << ' ' << e;
      EXPECT_GT(v, -1e-12);
      // Without restitution it stays on the floor until the end of the step, with friction.
      EXPECT_NEAR(s.velocity[0].x(), expected, mu * g * dt) << mu << ' ' << e;
      EXPECT_NEAR(s.angular_velocity[0].y(), spin - 5 * s.velocity[0].x() / (2 * r), 1e-9)
          << "about the point that touches";
    }
}

TEST_P(Rubbing, APairTakesTheGeometricMean) {
  Scene scene = on_a_plane(0.9, 0);
  scene.materials.push_back(Material{"ice", 1000, 0, 0.1, 0});
  scene.materials.push_back(Material{"teflon", 1000, 0, 0, 0});
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies.push_back(scene.bodies[0]);
  for (int i = 0; i < 3; ++i) {
    scene.bodies[static_cast<std::size_t>(i)].material = i;
    scene.bodies[static_cast<std::size_t>(i)].position.y() = 3 * i;
    scene.bodies[static_cast<std::size_t>(i)].velocity.x() = 10;
  }
  World world(scene, options());
  const BodyStates s = after(world, 12);
  for (int i = 0; i < 3; ++i) {
    const double mu = std::sqrt(0.9 * scene.materials[static_cast<std::size_t>(i)].friction);
    EXPECT_NEAR(s.velocity[static_cast<std::size_t>(i)].x(), 10 - mu * g * 0.1, 1e-9);
  }
}

/// Checks in each step that momenta are conserved and energy decreases. Returns the largest number of
/// mass-split contacts in a step.
std::int64_t expect_kept(Scene scene, const RunOptions& options) {
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = Precision::f64;
  scene.materials[0].friction = 0.6;
  scene.materials[0].restitution = 0.5;
  Random random(4);
  for (Body& body : scene.bodies)
    for (int k = 0; k < 3; ++k) body.angular_velocity[k] = random() / 4294967296.0 * 10 - 5;
  World world(scene, options);
  const StepStats before = world.measure();
  double scale = 0, last = before.energy();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    scale += world.initial().mass[i] * (scene.bodies[i].velocity.norm() + 1);
  std::int64_t split = 0;
  for (int step = 0; step < 40; ++step) {
    world.step();
    const StepStats now = world.measure();
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(now.momentum[k], before.momentum[k], 1e-13 * scale) << step;
      EXPECT_NEAR(now.angular_momentum[k], before.angular_momentum[k], 1e-12 * scale) << step;
    }
    EXPECT_LE(now.energy(), last * (1 + 1e-12)) << step;
    last = now.energy();
    split = std::max(split, now.uncoloured_contacts);
  }
  EXPECT_LT(last, 0.995 * before.energy());
  return split;
}

/// A hundred spheres slide on one so large that it is flat, and so heavy that it stays. Most of its contacts
/// are mass-split.
TEST_P(Rubbing, ManySlideOnASphereAsOnAPlane) {
  for (const double mass : {1e-3, 1.0, 1e3})
    for (const double mu : {0.1, 0.5}) {
      const double v0 = 7, radius = 0.5, large = 1e4;
      Scene scene = on_a_plane(mu, 0);
      scene.obstacles = {Plane{Vector3d(0, 0, 1), -2 * large, 0}};
      scene.bodies = {sphere(large, Vector3d(0, 0, -large))};
      scene.bodies[0].mass = 1e15;
      for (int k = 0; k < 100; ++k) {
        const double x = 1.5 * (k / 10), y = 1.5 * (k % 10), reach = large + radius;
        const Vector3d at(x, y, std::sqrt(reach * reach - x * x - y * y) - large);
        scene.bodies.push_back(sphere(radius, at, Vector3d(v0, 0, -v0 * x / reach)));
        scene.bodies.back().mass = mass;
      }
      World world(scene, options());
      const int steps = 12;
      const double slowed = mu * g * steps * scene.physics.time_step;
      const BodyStates s = after(world, steps);
      EXPECT_GT(world.measure().uncoloured_contacts, 50);
      for (std::size_t body = 1; body < scene.bodies.size(); ++body) {
        EXPECT_NEAR(s.velocity[body].x(), v0 - slowed, 0.03 * slowed)
            << body << ", " << mass << " kg, mu " << mu;
        EXPECT_NEAR(s.angular_velocity[body].y(), 2.5 * slowed / radius, 0.08 * slowed / radius)
            << body << ", " << mass << " kg, mu " << mu;
      }
    }
}

TEST_P(Rubbing, BetweenBodiesKeepsMomentaAndLosesEnergy) {
  Scene scene = empty_space();
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
      }
  expect_kept(scene, options());
}

TEST_P(Rubbing, OfManyOnOneIsMassSplit) {
  Scene scene = empty_space();
  scene.bodies.push_back(sphere(5, Vector3d(0, 0, 0)));
  Random random(3);
  while (scene.bodies.size() < 100) {
    Vector3d way(0, 0, 0);
    for (int axis = 0; axis < 3; ++axis) way[axis] = random() / 4294967296.0 - 0.5;
    way.normalize();
    bool apart = true;
    for (const Body& other : scene.bodies) apart = apart && (other.position - 5.4 * way).norm() > 0.65;
    if (apart) scene.bodies.push_back(sphere(0.3, 5.4 * way, -6 * way));
  }
  EXPECT_GT(expect_kept(scene, options()), 10);
}

TEST_P(Rubbing, OfAPileBringsItToRest) {
  Scene scene = box_collider(800);
  scene.generators[0].radius_max = 6;
  scene.generators[0].spawn = Spawn::apart;  // the correction of initial overlaps would add energy
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = 0.5;
  World world(scene, options());
  double last = world.measure().energy();
  for (int k = 0; k < 8; ++k) {
    world.step(50);
    const StepStats stats = world.measure();
    EXPECT_LT(stats.energy() - stats.push_work, last) << stats.step;
    EXPECT_EQ(stats.escaped, 0);
    EXPECT_EQ(stats.non_finite, 0);
    last = stats.energy() - stats.push_work;
  }
  // p(t) = p(0) + wall impulses including friction + m g t
  const StepStats stats = world.measure();
  double mass = 0;
  for (const double m : world.initial().mass) mass += m;
  const double t = 400 * scene.physics.time_step;
  EXPECT_NEAR(stats.momentum[0], stats.wall_impulse_vector[0], 1e-5 * mass * g * t);
  EXPECT_NEAR(stats.momentum[2], stats.wall_impulse_vector[2] - mass * g * t, 1e-5 * mass * g * t);
}

TEST_P(Rubbing, IsOneAnswer) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Scene scene = box_collider(800);
    scene.generators[0].radius_max = 7;
    scene.physics.solver = Solver::soft_step;
    scene.physics.precision = precision;
    scene.materials[0].friction = 0.5;
    World plain(scene, options());
    plain.step(40);
    ASSERT_GT(plain.measure().speculative, 200);
    const auto expect_same = [&](const RunOptions& o, const char* what) {
      World world(scene, o);
      world.step(20);
      world.measure();
      world.step(20);
      EXPECT_EQ(world.state_hash(), plain.state_hash()) << what;
    };
    for (const LaunchShape shape : {LaunchShape{1, 1}, {2, 4}, {16, 16}, {3, 37}}) {
      RunOptions o = options();
      o.shape = shape;
      expect_same(o, "launch shape");
      o.lane_order = LaneOrder::shuffled;
      o.cpu_threads = 2;
      if (GetParam() == ExecutorKind::cpu) expect_same(o, "shuffled lanes");
    }
    RunOptions tight = options();
    tight.initial_pair_capacity = 10;
    expect_same(tight, "tight capacities");
    RunOptions other = options();
    other.broad_phase = "uniform_grid";
    expect_same(other, "broad phase");

    World first(scene, options()), second(scene, options());
    first.step(25);
    second.step(3);
    second.restore(first);
    second.step(15);
    EXPECT_EQ(second.state_hash(), plain.state_hash()) << "another world";
  }
}

TEST_P(Rubbing, WhatIsNotCalledForCostsNothing) {
  Scene smooth = box_collider(500);
  smooth.physics.solver = Solver::soft_step;
  Scene rough = smooth, left_out = smooth;
  rough.materials[0].friction = 0.5;
  left_out.materials[0].friction = 0.5;
  left_out.physics.effects = Effects{.gravity = true};
  World a(smooth, options()), b(rough, options()), c(left_out, options());
  EXPECT_EQ(a.effects(), (Effects{.gravity = true}));
  EXPECT_EQ(b.effects(), (Effects{.gravity = true, .rotation = true, .friction = true}));
  const auto without = launches_by_stage(a);
  EXPECT_EQ(launches_by_stage(c), without);
  // Friction is part of the stages forces, bounce and relax. Without it, there is a second pass over contacts
  // and planes in solve and relax.
  auto expected = without;
  if (b.info().on_gpu) {
    const int pass = 4 * 2;
    expected["solve"] -= pass;
    expected["relax"] -= pass;
  }
  EXPECT_EQ(launches_by_stage(b), expected);
  EXPECT_EQ(a.info().allocated_bytes, c.info().allocated_bytes);
  EXPECT_GT(b.info().allocated_bytes, a.info().allocated_bytes);
  EXPECT_EQ(a.state_hash(), c.state_hash());
  EXPECT_NE(a.state_hash(), b.state_hash());
}

}  // namespace
}  // namespace collidoscope
