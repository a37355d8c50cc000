// Tests the recorded residual of each iteration against hand-computed impacts. Recording must not change the
// state.

#include "sim_cuda/solver/residual.h"

#include <gtest/gtest.h>

#include "sim_cuda/solver/soft_contact.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Residuals : public OnEachExecutor {};
ON_EACH_EXECUTOR(Residuals);

constexpr Solver all_solvers[] = {Solver::impulse, Solver::soft_step, Solver::jacobi_split};

/// Two equal spheres in contact that approach at 10 m/s.
Scene head_on(Solver solver) {
  Scene scene = empty_space();
  scene.physics.solver = solver;
  scene.physics.precision = Precision::f64;
  scene.physics.substeps = 1;
  scene.physics.iterations = 3;
  scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(5, 0, 0)),
                  sphere(1, Vector3d(2, 0, 0), Vector3d(-5, 0, 0))};
  return scene;
}

/// `count` spheres in a stack without cached impulses.
Scene stack(Solver solver, int count, int iterations) {
  Scene scene;
  scene.physics.solver = solver;
  scene.physics.precision = Precision::f64;
  scene.physics.substeps = 1;
  scene.physics.iterations = iterations;
  scene.materials[0].restitution = 0;
  if (solver != Solver::impulse) scene.obstacles.push_back({});
  // Velocities as after a fall of one step, so that the solver `impulse` also has work to do.
  for (int k = 0; k < count; ++k)
    scene.bodies.push_back(sphere(1, Vector3d(0, 0, 1 + 2 * k), Vector3d(0, 0, k == 0 ? 0 : -k)));
  return scene;
}

TEST_P(Residuals, ATwoBodyContactIsSolvedByOneSweep) {
  for (const Solver solver : all_solvers) {
    Scene scene = head_on(solver);
    double approach = 10;
    if (solver != Solver::impulse) {
      // Slower than the threshold of impacts, 2 g h = 0.65 m/s, so that the iterations solve the contact.
      approach = 0.5;
      scene.physics.gravity = Vector3d(0, 0, -9.81);
      scene.bodies[0].velocity.x() = approach / 2;
      scene.bodies[1].velocity.x() = -approach / 2;
    }
    World world(scene, options());
    world.records().record_residuals(true);
    world.step();
    const std::vector<Residual> residuals = world.records().residuals();
    ASSERT_EQ(residuals.size(), solver == Solver::impulse ? 4u : 8u);
    EXPECT_EQ(residuals[0].stage, "solve");
    EXPECT_EQ(residuals[0].iteration, 0);
    EXPECT_EQ(residuals[0].contacts, 1);
    // `impulse` applies the bounce within the iteration: 10 m/s of approach and 10 m/s of separation. A soft
    // contact yields slightly.
    const double all =
        solver == Solver::impulse ? 2 * approach : approach * Softness<double>::of(1.0 / 30, 3).mass_scale;
    EXPECT_NEAR(residuals[0].rms, all, 1e-12);
    EXPECT_EQ(residuals[0].max, residuals[0].rms);
    for (std::size_t k = 1; k < 4; ++k) {
      EXPECT_EQ(residuals[k].iteration, static_cast<int>(k));
      // A contact yields at once to the impulse of the first sweep, and at a fifth of it to that of later
      // ones.
      if (solver == Solver::impulse)
        EXPECT_LT(residuals[k].max, 1e-12);
      else
        EXPECT_LE(residuals[k].max, 0.05 * residuals[k - 1].max + 1e-12) << static_cast<int>(solver);
    }
  }
}

TEST_P(Residuals, AnImpactLeavesNothingToTheIterations) {
  for (const Solver solver : {Solver::soft_step, Solver::jacobi_split}) {
    World world(head_on(solver), options());
    world.records().record_residuals(true);
    world.step();
    const std::vector<Residual> residuals = world.records().residuals();
    ASSERT_EQ(residuals.size(), 8u);
    for (const Residual& residual : residuals) EXPECT_EQ(residual.max, 0);
    EXPECT_NEAR(world.bodies().velocity[1].x(), 5, 1e-12);
  }
}

TEST_P(Residuals, OfAStackFallFromSweepToSweep) {
  // The first iteration only moves the residual: the gain of one colour's contacts is the loss of the
  // other's. Mass splitting distributes half of it in each iteration.
  for (const Solver solver : all_solvers)
    for (const int count : {2, 5, 10}) {
      const std::size_t iterations = 40;
      World world(stack(solver, count, iterations), options());
      world.records().record_residuals(true);
      world.step();
      const std::vector<Residual> residuals = world.records().residuals();
      ASSERT_GE(residuals.size(), iterations + 1);
      EXPECT_GT(residuals[0].rms, 0.1);
      for (std::size_t k = 2; k <= iterations; ++k)
        EXPECT_LE(residuals[k].rms, residuals[k - 1].rms + 1e-13)
            << "solver " << static_cast<int>(solver) << ", " << count << " spheres, sweep " << k;
      EXPECT_LT(residuals[iterations].rms, (solver == Solver::jacobi_split ? 0.5 : 0.04) * residuals[0].rms);
    }
}

/// A box of spheres with friction.
Scene pile(Solver solver) {
  Scene scene = box_collider(400);
  scene.generators[0].radius_max = 7;
  scene.physics.solver = solver;
  scene.physics.substeps = 3;
  scene.physics.iterations = 2;
  scene.materials[0].friction = solver == Solver::impulse ? 0 : 0.5;
  return scene;
}

TEST_P(Residuals, AreTheSameAtEveryLaunchShapeAndCapacity) {
  for (const Solver solver : all_solvers) {
    RunOptions plain = options();
    World reference(pile(solver), plain);
    reference.records().record_residuals(true);
    reference.step(30);
    const std::vector<Residual> expected = reference.records().residuals();
    ASSERT_EQ(expected.size(), solver == Solver::impulse ? 3u * 3 : 3u * 2 * 3);
    EXPECT_EQ(expected.back().substep, 2);
    EXPECT_EQ(expected.back().iteration, 2);
    EXPECT_GT(expected[0].contacts, 20);
    // In solve, a contact that gets its first impulse recovers its overlap faster, so the residual may grow.
    const std::size_t first = solver == Solver::impulse ? 0 : 3;  // of relax
    EXPECT_GT(expected[first].rms, expected[first + 2].rms);
    for (const LaunchShape shape : {LaunchShape{1, 1}, {2, 4}, {16, 16}}) {
      RunOptions o = options();
      o.shape = shape;
      o.initial_pair_capacity = 60;
      World world(pile(solver), o);
      world.records().record_residuals(true);
      world.step(30);
      EXPECT_EQ(world.records().residuals(), expected) << shape.blocks << " x " << shape.threads;
    }
    // The CPU result is the expected value for the GPU.
    RunOptions cpu = options();
    cpu.executor = ExecutorKind::cpu;
    World other(pile(solver), cpu);
    other.records().record_residuals(true);
    other.step(30);
    EXPECT_EQ(other.records().residuals(), expected);
  }
}

TEST_P(Residuals, OffTheyCostNothingAndOnTheyChangeNothing) {
  const auto launches = [](World& world) {
    int all = 0;
    for (const StageTime& stage : world.times().stages) all += static_cast<int>(stage.launches);
    return all;
  };
  for (const Solver solver : all_solvers) {
    World off(pile(solver), options()), on(pile(solver), options());
    on.records().record_residuals(true);
    for (World* world : {&off, &on}) world->step(20);
    EXPECT_EQ(off.state_hash(), on.state_hash());
    EXPECT_TRUE(off.records().residuals().empty());
    EXPECT_LT(off.info().allocated_bytes, on.info().allocated_bytes);
    EXPECT_LT(launches(off), launches(on));
    on.records().record_residuals(false);
    EXPECT_TRUE(on.records().residuals().empty());
    EXPECT_EQ(off.info().allocated_bytes, on.info().allocated_bytes);
  }
}

TEST_P(Residuals, LeaveOutWhoSleeps) {
  Scene scene = stack(Solver::soft_step, 3, 1);
  for (Body& body : scene.bodies) body.velocity = Vector3d(0, 0, 0);
  scene.physics.substeps = 4;
  scene.physics.sleep = Sleep{};
  World world(scene, options());
  world.records().record_residuals(true);
  world.step();
  EXPECT_EQ(world.records().residuals()[1].contacts, 3) << "two between them, and the floor";
  world.step(60);
  ASSERT_EQ(world.measure().asleep, 3);
  for (const Residual& residual : world.records().residuals()) {
    EXPECT_EQ(residual.contacts, 0);
    EXPECT_EQ(residual.rms, 0);
  }
}

}  // namespace
}  // namespace collidoscope
