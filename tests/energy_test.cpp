// Hashes agree on garbage too, so energy is tested: it never rises where restitution <= 1, but for the
// positional push's own part; and nobody leaves the box.

#include <cmath>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Energy : public OnEachExecutor {
 protected:
  /// Steps, and checks every `every` steps. What rounding may add: the sums carry about 1e-7 of the total in
  /// float.
  void expect_no_rise(const Scene& scene, int steps, int every) {
    World world(scene, options());
    double last = world.measure().energy();
    const double tolerance = 2e-6 * std::abs(last);
    for (int done = 0; done < steps; done += every) {
      world.step(every);
      const StepStats stats = world.measure();
      const double now = stats.energy() - stats.push_work;
      ASSERT_LE(now, last + tolerance) << "step " << stats.step << " of N = " << stats.bodies;
      ASSERT_EQ(stats.escaped, 0) << "step " << stats.step;
      ASSERT_EQ(stats.non_finite, 0) << "step " << stats.step;
      last = now;
    }
  }
};
ON_EACH_EXECUTOR(Energy);

TEST_P(Energy, NeverRisesInThePaperBox2000) { expect_no_rise(box_collider(2000), 300, 1); }
TEST_P(Energy, NeverRisesInThePaperBox5000) { expect_no_rise(box_collider(5000), 300, 4); }
TEST_P(Energy, NeverRisesInThePaperBox10000) { expect_no_rise(box_collider(10000), 300, 20); }
TEST_P(Energy, NeverRisesInTheScaledBox50000) {
  expect_no_rise(box_collider(50000, Variant::scaled), 300, 50);
}

TEST_P(Energy, NeverRisesWithSubstepsIterationsAndPerfectBounces) {
  Scene scene = box_collider(800);
  scene.materials[0].restitution = 1;
  scene.physics.substeps = 2;
  scene.physics.iterations = 5;
  scene.generators[0].speed_max = 50;
  expect_no_rise(scene, 200, 1);
}

TEST_P(Energy, OfAnElasticGasIsKept) {
  // No gravity, e = 1, and spheres that start apart: every impulse keeps the energy exactly but for rounding.
  Scene scene = project_scene("gas");
  scene.physics.precision = Precision::f64;
  World world(scene, options());
  const double start = world.measure().energy();
  ASSERT_GT(start, 0);
  world.step(300);
  EXPECT_NEAR(world.measure().energy() / start, 1, 1e-12);
}

TEST_P(Energy, OfOneBallFallsByTheDriftOfItsIntegrator) {
  // Semi-implicit Euler loses 1/2 m g^2 h^2 a step in free flight, and a perfect bounce takes nothing.
  Scene scene = empty_space();
  scene.physics.precision = Precision::f64;
  scene.physics.gravity = Vector3d(0, 0, -9.81);
  scene.box = Box{};
  scene.bodies = {sphere(1, Vector3d(50, 50, 30))};
  World world(scene, options());
  const double start = world.measure().energy(), mass = world.initial().mass[0], h = scene.physics.time_step;
  world.step(50);
  EXPECT_NEAR(world.measure().energy(), start - 50 * mass * 9.81 * 9.81 * h * h / 2, 1e-9 * start);
}

TEST_P(Energy, PushesAreReportedAsTheirOwn) {
  // A sphere that starts half sunk into the floor is pushed out: the gain is the push's.
  Scene scene = empty_space();
  scene.physics.gravity = Vector3d(0, 0, -9.81);
  scene.box = Box{};
  scene.bodies = {sphere(2, Vector3d(50, 50, 1))};
  World world(scene, options());
  const double before = world.measure().energy();
  world.step();
  const StepStats stats = world.measure();
  EXPECT_NEAR(stats.push_work, world.initial().mass[0] * 9.81 * 1, 1e-3 * stats.push_work);
  EXPECT_NEAR(stats.energy() - stats.push_work, before, 1e-5 * before);
  EXPECT_NEAR(stats.max_penetration, 0, 1e-5);
}

}  // namespace
}  // namespace collidoscope
