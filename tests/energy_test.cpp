// Tests of the total energy with the solver `impulse`. For restitution <= 1 it never increases, apart from
// the work of the position correction, which is reported as push_work. Also tests that no body leaves the
// box. Hash tests cannot detect such errors, because a wrong state can have the same hash on all executors.

#include <cmath>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Energy : public OnEachExecutor {
 protected:
  /// Makes `steps` steps and checks the energy after every `every` steps. Tolerance: 2e-6 of the initial
  /// energy, because sums of floats have a relative error of about 1e-7.
  void expect_no_rise(const Scene& scene, int steps, int every) {
    World world(scene, options());
    double last = world.measure().energy();
    const double tolerance = 2e-6 * std::abs(last);
    for (int done = 0; done < steps; done += every) {
      world.step(every);
      const StepStats stats = world.measure();
      const double now = stats.energy() - stats.push_work;
      ASSERT_LE(now, last + tolerance) << "energy in J after step " << stats.step << ", N = " << stats.bodies;
      ASSERT_EQ(stats.escaped, 0) << "bodies outside the box after step " << stats.step;
      ASSERT_EQ(stats.non_finite, 0) << "bodies that are not finite after step " << stats.step;
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

TEST_P(Energy, NeverRisesWithRestitution1SubstepsAndIterations) {
  Scene scene = box_collider(800);
  scene.materials[0].restitution = 1;
  scene.physics.substeps = 2;
  scene.physics.iterations = 5;
  scene.generators[0].speed_max = 50;
  expect_no_rise(scene, 200, 1);
}

TEST_P(Energy, OfAnElasticGasIsConserved) {
  // No gravity, restitution 1, no initial overlap. Each impulse conserves the energy up to rounding.
  Scene scene = project_scene("gas");
  scene.physics.precision = Precision::f64;
  World world(scene, options());
  const double start = world.measure().energy();
  ASSERT_GT(start, 0);
  world.step(300);
  EXPECT_NEAR(world.measure().energy() / start, 1, 1e-12);
}

TEST_P(Energy, OfAFallingBallDecreasesByTheErrorOfTheIntegrator) {
  // Semi-implicit Euler loses 1/2 m g^2 h^2 per step in free flight, velocity Verlet nothing. An elastic
  // bounce loses nothing.
  for (const Integrator integrator : {Integrator::semi_implicit_euler, Integrator::velocity_verlet}) {
    Scene scene = empty_space();
    scene.physics.precision = Precision::f64;
    scene.physics.integrator = integrator;
    scene.physics.gravity = Vector3d(0, 0, -9.81);
    scene.box = Box{};
    scene.bodies = {sphere(1, Vector3d(50, 50, 30))};
    World world(scene, options());
    const double start = world.measure().energy(), mass = world.initial().mass[0],
                 h = scene.physics.time_step;
    world.step(50);
    const double loss =
        integrator == Integrator::semi_implicit_euler ? 50 * mass * 9.81 * 9.81 * h * h / 2 : 0;
    EXPECT_NEAR(world.measure().energy(), start - loss, 1e-9 * start);
  }
}

TEST_P(Energy, WorkOfPositionCorrectionIsReportedAsPushWork) {
  // A sphere of radius 2 m starts with its centre 1 m above the floor. The position correction lifts it by
  // 1 m; its work m g (1 m) is the gain of energy.
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
