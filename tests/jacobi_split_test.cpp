// Tests the solver jacobi_split: properties shared with soft_step, and that only its impacts are coloured.

#include "sim_cuda/solver/soft_step.h"

#include <cmath>
#include <numbers>

#include "tests/executors.h"
#include "tests/impact_scenes.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class JacobiSplit : public OnEachExecutor {
 protected:
  static Scene pile(std::int64_t bodies, Solver solver) {
    Scene scene = box_collider(bodies);
    scene.generators[0].radius_max = 6;
    scene.generators[0].spawn = Spawn::apart;
    scene.physics.solver = solver;
    return scene;
  }
};
ON_EACH_EXECUTOR(JacobiSplit);

TEST_P(JacobiSplit, IterationsHaveAllContactsInTheMassSplitSet) {
  World world(pile(500, Solver::jacobi_split), options());
  world.step(100);
  const StepStats stats = world.measure();
  EXPECT_GT(stats.speculative, 100);
  EXPECT_EQ(stats.uncoloured_contacts, stats.speculative);
  // Two spheres overlap the one between them. If all contacts act at once, it stays.
  for (const Solver solver : {Solver::soft_step, Solver::jacobi_split}) {
    Scene scene = empty_space();
    scene.physics.solver = solver;
    scene.physics.precision = Precision::f64;
    scene.physics.substeps = 1;
    scene.bodies = {sphere(1, Vector3d(0, 0, 0)), sphere(1, Vector3d(-1.9, 0, 0)),
                    sphere(1, Vector3d(1.9, 0, 0))};
    World three(scene, options());
    three.step();
    const BodyStates s = three.bodies();
    EXPECT_LT(s.position[1].x(), -1.9 - 1e-4);
    EXPECT_GT(s.position[2].x(), 1.9 + 1e-4);
    if (solver == Solver::jacobi_split)
      EXPECT_LT(std::abs(s.position[0].x()), 1e-15);
    else
      EXPECT_GT(std::abs(s.position[0].x()), 1e-4) << "the colours act one after another";
  }
}

TEST_P(JacobiSplit, ImpactsAreColouredAsThoseOfSoftStep) {
  // A ball hits the middle one of three that touch. Mass splitting would give both sides the same velocity.
  Scene scene = empty_space();
  scene.physics.precision = Precision::f64;
  scene.bodies = {sphere(1, Vector3d(-2.02, 0, 0), Vector3d(10, 0, 0)), sphere(1, Vector3d(0, 0, 0)),
                  sphere(1, Vector3d(1, std::sqrt(3.0), 0)), sphere(1, Vector3d(1, -std::sqrt(3.0), 0))};
  scene.physics.solver = Solver::soft_step;
  World coloured(scene, options());
  scene.physics.solver = Solver::jacobi_split;
  World split(scene, options());
  for (World* world : {&coloured, &split}) {
    const double before = world->measure().energy();
    world->step(2);
    EXPECT_NEAR(world->measure().energy(), before, 1e-12 * before);
  }
  const BodyStates s = split.bodies(), c = coloured.bodies();
  EXPECT_GT(s.velocity[2].x(), 1) << "they were hit";
  EXPECT_GT(std::abs(s.velocity[2].x() - s.velocity[3].x()), 0.1) << "one after the other";
  for (const std::size_t body : {0, 1, 2, 3})
    EXPECT_LT((s.velocity[body] - c.velocity[body]).norm(), 1e-12) << body;
}

TEST_P(JacobiSplit, OneContactIsThatOfSoftStep) {
  Scene scene;
  scene.materials[0].restitution = 0.5;
  scene.physics.gravity = Vector3d(0, 0, 0);
  scene.physics.precision = Precision::f64;
  for (const double x : {-1.5, 1.5}) {
    Body body;
    body.position = Vector3d(x, 0, 0);
    body.velocity = Vector3d(-x, 0.1 * x, 0);
    body.radius = x < 0 ? 1 : 0.7;
    scene.bodies.push_back(body);
  }
  scene.physics.solver = Solver::soft_step;
  World coloured(scene, options());
  scene.physics.solver = Solver::jacobi_split;
  World split(scene, options());
  coloured.step(40);
  split.step(40);
  ASSERT_GT(coloured.bodies().velocity[1].x(), 0) << "they bounced";
  for (const std::size_t body : {0, 1})
    EXPECT_LT((split.bodies().velocity[body] - coloured.bodies().velocity[body]).norm(), 1e-12);
}

TEST_P(JacobiSplit, KeepsMomentumAndGainsNoEnergy) {
  // A heavy sphere flies into a wall of light ones: one body has many contacts.
  Scene scene;
  scene.physics.gravity = Vector3d(0, 0, 0);
  scene.physics.precision = Precision::f64;
  scene.physics.solver = Solver::jacobi_split;
  scene.physics.effects = Effects{};
  for (int y = -4; y <= 4; ++y)
    for (int z = -4; z <= 4; ++z) {
      Body body;
      body.radius = 0.5;
      body.position = Vector3d(0, 1.001 * y, 1.001 * z);
      scene.bodies.push_back(body);
    }
  Body heavy;
  heavy.radius = 6;
  heavy.position = Vector3d(-8, 0.1, 0.2);
  heavy.velocity = Vector3d(10, 0, 0);
  scene.bodies.push_back(heavy);
  World world(scene, options());
  const StepStats before = world.measure();
  double last = before.energy();
  for (int k = 0; k < 30; ++k) {
    world.step();
    const StepStats now = world.measure();
    EXPECT_LE(now.energy(), last * (1 + 1e-12)) << k;
    last = now.energy();
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(now.momentum[axis], before.momentum[axis], 1e-9 * before.momentum[0]);
  }
  EXPECT_GT(world.bodies().velocity[40].x(), 5) << "the middle one was hit";
}

TEST_P(JacobiSplit, AColumnHasTheStiffnessOfWholeBodies) {
  constexpr int count = 6;
  for (const Solver solver : {Solver::soft_step, Solver::jacobi_split}) {
    Scene scene;
    scene.physics.solver = solver;
    scene.physics.precision = Precision::f64;
    scene.physics.time_step = TimeStep::per_second(60);
    scene.obstacles.push_back(Plane{});
    for (int k = 0; k < count; ++k) {
      Body body = sphere(0.5, Vector3d(0, 0, 0.5 + k));
      body.mass = 2;
      scene.bodies.push_back(body);
    }
    World world(scene, options());
    world.step(600);
    const BodyStates s = world.bodies();
    const double omega = std::numbers::pi / 2 * 240;  // 1/s: a quarter of a turn per substep
    for (std::size_t k = 0; k + 1 < count; ++k) {
      const double load = static_cast<double>(count - 1 - k) * 2 * 9.81;  // N; effective mass: 1 kg
      EXPECT_NEAR(1 - (s.position[k + 1].z() - s.position[k].z()), load / (omega * omega),
                  0.01 * load / (omega * omega))
          << name_of(solver_names, solver) << ' ' << k;
    }
  }
}

/// Balls that an impact sets in motion overlap others until the next step. Further passes must not push them.
TEST_P(JacobiSplit, MoreIterationsDoNotCostEnergyInARack) {
  Scene scene = billiard_rack(0, 1);
  scene.physics.time_step = TimeStep::per_second(60);
  for (const Solver solver : {Solver::soft_step, Solver::jacobi_split})
    for (const int iterations : {1, 2, 4, 8}) {
      scene.physics.solver = solver;
      scene.physics.iterations = iterations;
      World world(scene, options());
      const double before = world.measure().energy();
      world.step(20);
      EXPECT_NEAR(world.measure().energy() / before, 1, 5e-4)
          << name_of(solver_names, solver) << ' ' << iterations;
    }
}

TEST_P(JacobiSplit, PilesComeToRestAsWithColours) {
  World split(pile(800, Solver::jacobi_split), options());
  World coloured(pile(800, Solver::soft_step), options());
  split.step(600);
  coloured.step(600);
  const StepStats s = split.measure(), c = coloured.measure();
  EXPECT_EQ(s.escaped + s.non_finite, 0);
  for (const StepStats& stats : {s, c}) EXPECT_LT(stats.max_penetration, 0.25) << "m, of radii of up to 6 m";
  double mass = 0;
  for (const double m : split.initial().mass) mass += m;
  EXPECT_LT(s.kinetic_energy, 1e-3 * mass * 9.81 * 50) << "of what the fall released";
}

TEST_P(JacobiSplit, IsOneAnswer) {
  Scene scene = pile(600, Solver::jacobi_split);
  scene.materials[0].friction = 0.4;
  World plain(scene, options());
  plain.step(60);
  for (const LaunchShape shape : {LaunchShape{1, 1}, {2, 4}, {3, 37}})
    for (const LaneOrder order : {LaneOrder::contiguous, LaneOrder::shuffled}) {
      RunOptions o = options();
      o.shape = shape;
      o.lane_order = order;
      World world(scene, o);
      world.step(60);
      EXPECT_EQ(world.state_hash(), plain.state_hash());
    }
}

}  // namespace
}  // namespace collidoscope
