// Tests soft_step against formulas: weights, rebounds, Newton's law of impact and momenta. Also tests that
// piles come to rest.

#include <algorithm>
#include <cmath>

#include "sim_cuda/solver/soft_contact.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class SoftStep : public OnEachExecutor {};
ON_EACH_EXECUTOR(SoftStep);

Scene soft_space(Precision precision = Precision::f64) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = precision;
  return scene;
}

/// `count` spheres of 0.5 m in a tube 1.1 m wide, alternately off its axis; 60 steps per second, 4 substeps.
Scene column(int count, Precision precision) {
  Scene scene = soft_space(precision);
  scene.physics.gravity = Vector3d(0, 0, -9.81);
  scene.physics.time_step = 1.0 / 60;
  scene.materials[0].restitution = 0;
  for (int i = 0; i < count; ++i)
    scene.bodies.push_back(sphere(0.5, Vector3d(i % 2 ? 0.04 : -0.04, 0, 0.5 + i)));
  scene.obstacles = {Plane{Vector3d(0, 0, 1), 0, 0}};
  for (const double side : {-1.0, 1.0}) {
    scene.obstacles.push_back(Plane{Vector3d(side, 0, 0), -0.55, 0});
    scene.obstacles.push_back(Plane{Vector3d(0, side, 0), -0.55, 0});
  }
  return scene;
}

TEST_P(SoftStep, OneBodyAtRestWeighsMg) {
  Scene scene = soft_space();
  scene.physics.gravity = Vector3d(0, 0, -9.81);
  scene.box = Box{};
  scene.bodies = {sphere(1, Vector3d(50, 50, 1))};
  World world(scene, options());
  world.step(300);
  EXPECT_NEAR(world.bodies().position[0].z(), 1, 1e-12);
  EXPECT_NEAR(world.measure().wall_impulse, world.initial().mass[0] * 9.81 * 10,
              1e-9 * world.measure().wall_impulse);
}

TEST_P(SoftStep, TwentyStackedInATubeHoldAndEachContactBearsWhatStandsOnIt) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const int count = 20;
    World world(column(count, precision), options());
    world.records().record_impulses(true);
    world.step(900);
    const StepStats stats = world.measure();
    EXPECT_LT(stats.max_speed, 2e-3);
    EXPECT_LT(stats.max_penetration, 0.005) << "1 % of the radius";
    const BodyStates states = world.bodies();
    const double mass = world.initial().mass[0];
    int found = 0;
    for (const ContactImpulse& contact : world.records().impulses()) {
      if (contact.b != contact.a + 1) continue;
      const Vector3d normal = (states.position[contact.b] - states.position[contact.a]).normalized();
      const double force = contact.impulse / world.scene().physics.time_step;
      const double weight = (count - 1 - static_cast<int>(contact.a)) * mass * 9.81;
      EXPECT_NEAR(force * normal.z(), weight, 0.01 * weight) << contact.a;
      ++found;
    }
    EXPECT_EQ(found, count - 1);
  }
}

TEST_P(SoftStep, AColumnCarriesAHundredTimesItsSpheresMass) {
  Scene scene = column(20, Precision::f32);
  const double mass = 1000 * 0.5235987755982988;
  scene.bodies.back().mass = 100 * mass;
  World world(scene, options());
  world.step(1200);
  const StepStats stats = world.measure();
  EXPECT_LT(stats.max_speed, 0.01);
  EXPECT_LT(stats.max_penetration, 0.025) << "5 % of the radius";
}

TEST(Softness, ALoadSinksInByItsStiffness) {
  // In static equilibrium the spring alone carries the load: depth = load / (mass omega^2), load in N. The
  // relax iterations cancel the bias impulse, so at this depth the impulse no longer changes.
  const double h = 1.0 / 240, load = 7, mass = 3;
  const Softness<double> softness = Softness<double>::of(h, 1);
  const double omega = 2 * 3.14159265358979323846 * Softness<double>::cycles_per_substep / h;
  SoftContact<double> contact{};
  contact.radius = 1;
  contact.impulse = load * h;
  contact.gap = -load / (mass * omega * omega);
  EXPECT_NEAR(contact.solve<true>(0, mass, softness) / (load * h), 0, 1e-12);
}

TEST(Softness, AContactWithALoadKeepsAMultipleOfItsOverlap) {
  const double h = 1.0 / 240, load = 7, mass = 3;
  const double omega = 2 * 3.14159265358979323846 * Softness<double>::cycles_per_substep / h;
  for (const bool with_friction : {false, true}) {
    const Softness<double> softness = Softness<double>::of(h, 2, true, with_friction);
    const auto change = [&](double overlaps) {
      SoftContact<double> contact{};
      contact.radius = 1;
      contact.impulse = load * h;
      contact.gap = -overlaps * load / (mass * omega * omega);
      return contact.solve<true>(0, mass, softness) / (load * h);
    };
    const double kept = Softness<double>::pulled_kept_overlap;
    EXPECT_LT(change(0.99), -1e-4) << "yields";
    EXPECT_NEAR(change(1.01), 0, 1e-12);
    EXPECT_NEAR(change(kept - 0.01), 0, 1e-12);
    EXPECT_GT(change(kept + 0.01), 1e-4) << "recovers";
  }
}

TEST_P(SoftStep, AColumnSinksInByThatMuch) {
  Scene scene = column(2, Precision::f64);
  for (Body& body : scene.bodies) body.position.x() = 0;
  World world(scene, options());
  world.step(300);
  const double h = world.scene().physics.time_step / 4;
  const double omega = 2 * 3.14159265358979323846 * Softness<double>::cycles_per_substep / h;
  EXPECT_NEAR(world.measure().max_penetration, 9.81 * 2 / (omega * omega), 1e-9) << "mass is m/2, load m g";
}

TEST_P(SoftStep, AColumnWithGapsIsStoppedBallByBall) {
  // 20 balls with gaps of 3 mm fall at one velocity. Several are stopped in a step, one after the other. If
  // the ones above were no contacts, they would fall into those that stand: by 62 mm.
  for (const Solver solver : {Solver::soft_step, Solver::jacobi_split}) {
    Scene scene = column(20, Precision::f64);
    scene.physics.solver = solver;
    World world(scene, options());
    double deepest = 0, most = 0;
    for (int k = 0; k < 200; ++k) {
      world.step();
      const StepStats stats = world.measure();
      deepest = std::max(deepest, stats.max_penetration);
      most = std::max(most, stats.kinetic_energy);
    }
    EXPECT_LT(deepest, 0.006) << "m; the weight of the column gives 0.0026";
    EXPECT_LT(world.measure().push_work, 0.01 * most) << name_of(solver_names, solver);
  }
}

TEST_P(SoftStep, ReboundsRiseToTheSquareOfRestitution) {
  for (const double e : {0.5, 0.8, 1.0}) {
    Scene scene = soft_space();
    scene.physics.gravity = Vector3d(0, 0, -9.81);
    scene.physics.time_step = 1.0 / 120;
    scene.materials[0].restitution = e;
    scene.box = Box{};
    scene.bodies = {sphere(1, Vector3d(50, 50, 11.003))};
    World world(scene, options());
    const double fall = 10.003, g = 9.81, h = scene.physics.time_step / 4;
    double peak = 0, expected = fall, loss = 0;
    int bounces = 0;
    for (int k = 0; k < 1500 && bounces < 4; ++k) {
      const double before = world.bodies().velocity[0].z();
      world.step();
      const double now = world.bodies().velocity[0].z(), z = world.bodies().position[0].z() - 1;
      if (before > 0 && now <= 0) {
        // Semi-implicit Euler loses g h / 2 of height per second. A peak may lie between two states.
        expected *= e * e;
        loss = e * e * loss + g * h * std::sqrt(2 * expected / g) * (1 + e);
        EXPECT_LE(std::max(peak, z), expected + 1e-9) << "a bounce gains nothing";
        EXPECT_GE(std::max(peak, z), expected - loss - g * scene.physics.time_step * scene.physics.time_step)
            << e << ' ' << bounces;
        ++bounces;
        peak = 0;
      }
      peak = now > 0 ? std::max(peak, z) : 0;
    }
    EXPECT_EQ(bounces, 4);
  }
}

TEST_P(SoftStep, HeadOnImpactsFollowNewton) {
  for (const double e : {0.0, 0.3, 0.8, 1.0})
    for (const double mass : {1e-3, 1.0, 7.0, 1e6})
      for (const double gap : {0.0, 0.37, 1.03}) {
        Scene scene = soft_space();
        scene.materials[0].restitution = e;
        Body a = sphere(1, Vector3d(0, 0, 0), Vector3d(5, 0, 0)),
             b = sphere(0.5, Vector3d(1.5 + gap, 0, 0), Vector3d(-1, 0, 0));
        a.mass = 2;
        b.mass = mass;
        scene.bodies = {a, b};
        World world(scene, options());
        world.step(15);
        const BodyStates states = world.bodies();
        const double center = (2 * 5 - mass) / (2 + mass), closing = 6;
        EXPECT_NEAR(states.velocity[0].x(), center - mass * e * closing / (2 + mass), 1e-11 * closing);
        EXPECT_NEAR(states.velocity[1].x(), center + 2 * e * closing / (2 + mass), 1e-11 * closing);
      }
}

TEST_P(SoftStep, WhatOthersPushIntoAWallBouncesByOneImpactAfterAnother) {
  // A body at rest at a wall is hit. The two bodies collide by Newton's law, then the body hits the wall by
  // the same law, and so on until they separate. Solver velocities into the wall must not bounce. Otherwise
  // the result depended on the time step, and bodies wedged at walls did not come to rest.
  const double e = 0.5;
  double first = 0, second = -10;
  while (first < 0 || second < first) {
    const double impulse = (1 + e) * (first - second) / 2;
    first -= impulse;
    second += impulse;
    if (first < 0) first *= -e;
  }
  for (int k = 0; k < 2; ++k) {
    Scene scene = soft_space();
    scene.physics.time_step = k == 0 ? 1.0 / 30 : 1.0 / 240;
    scene.materials[0].restitution = e;
    scene.obstacles = {Plane{Vector3d(1, 0, 0), 0, 0}};
    scene.bodies = {sphere(1, Vector3d(1, 0, 0)), sphere(1, Vector3d(4.0123, 0, 0), Vector3d(-10, 0, 0))};
    World world(scene, options());
    world.step(k == 0 ? 30 : 240);
    EXPECT_NEAR(world.bodies().velocity[0].x(), first, 1e-9);
    EXPECT_NEAR(world.bodies().velocity[1].x(), second, 1e-9);
  }
}

TEST_P(SoftStep, MomentaAreKeptToRounding) {
  // No walls and no gravity; overlaps, coincident centres and impacts.
  for (const unsigned seed : {3u, 8u, 21u})
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      Scene scene = random_scene(seed, 300);
      scene.box.reset();
      scene.physics.gravity = Vector3d(0, 0, 0);
      scene.physics.solver = Solver::soft_step;
      scene.physics.precision = precision;
      World world(scene, options());
      const StepStats before = world.measure();
      double scale = 0;
      for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        scale += world.initial().mass[i] * (scene.bodies[i].velocity.norm() + 1);
      world.step(60);
      const StepStats after = world.measure();
      const double tolerance = precision == Precision::f32 ? 1e-5 : 1e-14;
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(after.momentum[k], before.momentum[k], tolerance * scale) << seed;
        EXPECT_NEAR(after.angular_momentum[k], before.angular_momentum[k], 100 * tolerance * scale) << seed;
      }
    }
}

TEST_P(SoftStep, MomentumIsBalancedByTheWalls) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Scene scene = box_collider(1000);
    scene.generators[0].speed_max = 30;
    scene.physics.solver = Solver::soft_step;
    scene.physics.precision = precision;
    World world(scene, options());
    const StepStats before = world.measure();
    double mass = 0;
    for (const double m : world.initial().mass) mass += m;
    world.step(120);
    const StepStats after = world.measure();
    for (int k = 0; k < 3; ++k) {
      const double given = after.wall_impulse_vector[k] + mass * scene.physics.gravity[k] * 4;
      EXPECT_NEAR(after.momentum[k] - before.momentum[k], given,
                  (precision == Precision::f32 ? 1e-5 : 1e-13) * mass * 30);
    }
  }
}

TEST_P(SoftStep, FastBodiesNeverCrossAWall) {
  Scene scene = soft_space(Precision::f32);
  scene.physics.gravity = Vector3d(0, 0, -9.81);
  scene.box = Box{};
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const auto u = [&] { return random() / 4294967296.0; };
    scene.bodies.push_back(sphere(1e-6 + 0.5 * u() * u(), Vector3d(1 + 98 * u(), 1 + 98 * u(), 1 + 98 * u()),
                                  Vector3d(2e4 * (u() - 0.5), 2e4 * (u() - 0.5), 2e4 * (u() - 0.5))));
  }
  World world(scene, options());
  for (int k = 0; k < 60; ++k) {
    world.step();
    ASSERT_EQ(world.measure().escaped, 0);
  }
}

TEST_P(SoftStep, ThePaperBoxComesToRestWhereImpulsesLetItSink) {
  struct Rest {
    double rms, deepest, speed;  // depth over the smaller radius; median, m/s
  };
  const auto rest = [&](Solver solver) {
    Scene scene = box_collider(2000);
    scene.physics.solver = solver;
    scene.physics.substeps = 4;
    World world(scene, options());
    double last = world.measure().energy();
    for (int k = 0; k < 6; ++k) {
      world.step(100);
      const StepStats stats = world.measure();
      EXPECT_LT(stats.energy() - stats.push_work, last) << stats.step;
      EXPECT_EQ(stats.escaped, 0);
      last = stats.energy() - stats.push_work;
    }
    world.detect();
    const BodyStates states = world.bodies();
    const std::vector<double>& radius = world.initial().radius;
    Rest found{0, 0, 0};
    int contacts = 0;
    for (const auto& [a, b] : world.pairs()) {
      const double depth = radius[a] + radius[b] - (states.position[a] - states.position[b]).norm();
      if (depth < 0) continue;
      const double relative = depth / std::min(radius[a], radius[b]);
      found.rms += relative * relative;
      found.deepest = std::max(found.deepest, relative);
      ++contacts;
    }
    found.rms = std::sqrt(found.rms / contacts);
    std::vector<double> speed;
    for (const Vector3d& v : states.velocity) speed.push_back(v.norm());
    std::ranges::nth_element(speed, speed.begin() + 1000);
    found.speed = speed[1000];
    return found;
  };
  const Rest soft = rest(Solver::soft_step), hard = rest(Solver::impulse);
  EXPECT_LT(soft.rms, 0.01);
  EXPECT_LT(soft.deepest, 0.2);
  EXPECT_LT(soft.speed, 0.2);
  EXPECT_GT(hard.rms, 5 * soft.rms);
  EXPECT_GT(hard.speed, 2 * soft.speed);
}

TEST_P(SoftStep, AnElasticGasKeepsItsEnergy) {
  Scene scene = project_scene("gas");
  scene.physics.solver = Solver::soft_step;
  World world(scene, options());
  const double start = world.measure().energy();
  world.step(1200);
  EXPECT_NEAR(world.measure().energy() / start, 1, 0.02);
}

TEST_P(SoftStep, GoesOnInAnotherWorldBitForBit) {
  Scene scene = box_collider(600);
  scene.generators[0].radius_max = 8;
  scene.physics.solver = Solver::soft_step;
  World straight(scene, options()), first(scene, options()), second(scene, options());
  straight.step(60);
  first.step(40);
  second.step(3);  // a different history
  second.restore(first);
  second.step(20);
  EXPECT_EQ(second.state_hash(), straight.state_hash());
}

TEST_P(SoftStep, RecordingImpulsesChangesNothing) {
  Scene scene = box_collider(800);
  scene.physics.solver = Solver::soft_step;
  RunOptions o = options();
  o.initial_pair_capacity = 100;  // the list grows during the recording
  World off(scene, o), on(scene, o);
  on.records().record_impulses(true);
  for (int k = 0; k < 30; ++k) {
    off.step();
    on.step();
    on.measure();
    ASSERT_EQ(on.state_hash(), off.state_hash()) << k;
  }
  EXPECT_GT(on.measure().max_impulse, 0);
}

TEST_P(SoftStep, AnEffectThatIsOffCostsNoLaunchAndNoByte) {
  Scene still = box_collider(300);
  still.physics.solver = Solver::soft_step;
  Scene open = still;
  open.box.reset();
  open.generators.clear();
  open.bodies = {sphere(1, Vector3d(0, 0, 0))};
  Scene walled = open;
  walled.obstacles = {Plane{}};
  World a(open, options()), b(walled, options());
  EXPECT_GT(b.info().allocated_bytes, a.info().allocated_bytes);
  const auto launches = [](World& world) {
    world.step(2);
    int sum = 0;
    for (const StageTime& stage : world.times().stages) sum += stage.launches;
    return sum;
  };
  // Planes add a stage to each of the two passes before a move and after it, and one for the bounce.
  EXPECT_EQ(launches(b) - launches(a), 4 * 2 * 2 + 1);
}

}  // namespace
}  // namespace collidoscope
