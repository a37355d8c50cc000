// Tests that energy never rises for restitution <= 1, except by the reported work of the position correction,
// and that no body leaves the box. Equal hashes do not show this: they also agree on wrong states.

#include <cmath>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Energy : public OnEachExecutor {
 protected:
  /// Steps and checks the energy every `every` steps. Tolerance: float sums have an error of about 1e-7 of
  /// the total.
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
  // No gravity, e = 1, and spheres that start apart: each impulse conserves the energy up to rounding.
  Scene scene = project_scene("gas");
  scene.physics.precision = Precision::f64;
  World world(scene, options());
  const double start = world.measure().energy();
  ASSERT_GT(start, 0);
  world.step(300);
  EXPECT_NEAR(world.measure().energy() / start, 1, 1e-12);
}

TEST_P(Energy, OfOneBallFallsByTheDriftOfItsIntegrator) {
  // Semi-implicit Euler loses 1/2 m g^2 h^2 per step in free flight. An elastic bounce loses nothing.
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
  // A sphere starts half inside the floor. The energy gain is the work of the position correction.
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
