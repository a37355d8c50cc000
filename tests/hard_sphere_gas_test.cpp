// Tests the event-driven reference on gases of elastic spheres: conserved quantities, each event against a
// brute-force search of all pairs in long double, and the convergence of the time-stepped gas.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "sim_cuda/accuracy/errors.h"
#include "sim_cuda/reference/contact_time.h"
#include "sim_cuda/reference/hard_spheres.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/world.h"
#include "tests/brute_spheres.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

/// Spheres of radius U(0, 1) m that start apart with random velocities. By default some hundred fill 30 % of
/// the box.
Scene gas(std::int64_t count, Vector3d gravity, double e = 1, double side = 0) {
  Scene scene = hard_space(gravity, e);
  if (side == 0) side = newton_cube_root(static_cast<double>(count) * 1.0472 / 0.3);
  scene.box = Box{Vector3d(-1, 2, 3), Vector3d(-1, 2, 3) + Vector3d(side, side, side)};
  scene.generators = {{.count = count, .radius_max = 1, .spawn = Spawn::apart, .speed_max = 5}};
  return scene;
}

/// kg m/s
double sum_of_momenta(const HardSpheres& exact) {
  double sum = 0;
  const BodyStates states = exact.bodies();
  for (std::size_t i = 0; i < states.velocity.size(); ++i)
    sum += exact.initial().mass[i] * states.velocity[i].norm();
  return sum;
}

/// Largest overlap in m, over all pairs.
double deepest_overlap(const HardSpheres& exact) {
  double deepest = 0;
  const std::vector<Vector3d> x = exact.bodies().position;
  const std::vector<double>& radius = exact.initial().radius;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double reach = radius[i] + radius[j];
      const double square = (x[i] - x[j]).squaredNorm();
      if (square < reach * reach) deepest = std::max(deepest, reach - std::sqrt(square));
    }
  return deepest;
}

TEST(HardSphereGas, KeepsEnergyAndMomentumOver100000Collisions) {
  for (const Vector3d& gravity : {Vector3d(0, 0, 0), Vector3d(2, -1, -9.81)}) {
    HardSpheres exact(gas(200, gravity));
    const StepStats start = exact.measure();
    double mass = 0;
    for (const double m : exact.initial().mass) mass += m;
    for (int k = 0; k < 100; ++k) {
      for (int collision = 0; collision < 1000; ++collision) ASSERT_TRUE(exact.next_collision(never));
      const StepStats now = exact.measure();  // during a contact
      // Tolerance: rounding of coordinates, and of speed times time.
      const double rounding = 4e-16 * (20 + now.max_speed * exact.time());
      ASSERT_LE(now.max_penetration, rounding);
      ASSERT_LE(deepest_overlap(exact), rounding);
      ASSERT_EQ(now.escaped, 0);
      ASSERT_NEAR(now.energy(), start.energy(), 1e-12 * start.energy()) << exact.time();
      const double size = sum_of_momenta(exact);
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_NEAR(now.momentum[axis] - start.momentum[axis],
                    now.wall_impulse_vector[axis] + mass * gravity[axis] * exact.time(), 1e-12 * size)
            << exact.time();
    }
    EXPECT_GT(exact.counts().pairs, 50000);
    EXPECT_GT(exact.counts().planes, 20000);
    EXPECT_EQ(exact.dissipated(), 0);
  }
}

TEST(HardSphereGas, LosesWhatItsCollisionsDissipate) {
  HardSpheres exact(gas(300, Vector3d(0, 0, 0), 0.9));
  const StepStats start = exact.measure();
  ASSERT_TRUE(exact.advance_to(3)) << exact.zeno_line();
  EXPECT_LT(exact.measure().energy(), 0.5 * start.energy());
  EXPECT_NEAR(exact.measure().energy() + exact.dissipated(), start.energy(), 1e-12 * start.energy());
}

TEST(HardSphereGas, AnswersTheSameHoweverOftenItIsLookedAt) {
  const Scene scene = gas(200, Vector3d(0, 0, -9.81));
  HardSpheres once(scene), often(scene);
  once.advance_to(2);
  for (int k = 1; k <= 300; ++k) {
    often.advance_to(2 * k / 300.0);
    often.bodies();
  }
  EXPECT_EQ(once.bodies().position, often.bodies().position);
  EXPECT_EQ(once.bodies().velocity, often.bodies().velocity);
}

TEST(HardSphereGas, AgreesWithBruteForceEventByEvent) {
  for (const Vector3d& gravity : {Vector3d(0, 0, 0), Vector3d(0, 1, -9.81)}) {
    // A dense gas; and a thin one, whose small spheres cross the grid cells of three large ones.
    for (const bool thin : {false, true}) {
      Scene scene = gas(500, gravity, 1, thin ? 30 : 0);
      if (thin) {
        scene.generators[0].radius_max = 0.2;
        scene.generators[0].speed_max = 15;
        for (const double x : {2.0, 10.0, 20.0})
          scene.bodies.push_back(sphere(1.5, Vector3d(x, 12, 12), Vector3d(-3, 1, 7)));
      }
      HardSpheres exact(scene);
      BruteSpheres brute(scene, exact.initial());
      const int events = 1500;
      for (int k = 0; k < events; ++k) {
        const auto done = exact.next_collision(never);
        const CollisionEvent expected = brute.next();
        ASSERT_TRUE(done);
        ASSERT_NEAR(done->time, expected.time, 1e-6) << k;
        ASSERT_EQ(done->body, expected.body) << k;
        ASSERT_EQ(done->other, expected.other) << k;
        if (expected.other == no_body) {
          ASSERT_EQ(done->plane, expected.plane) << k;
        }
      }
      double error = 0;
      for (std::size_t i = 0; i < exact.initial().size(); ++i)
        error = std::max(error, (exact.bodies().position[i] - brute.positions()[i].cast<double>()).norm());
      EXPECT_LT(error, 1e-4);
    }
  }
}

TEST(HardSphereGas, OfTenThousandFallsAndKeepsItsEnergy) {
  HardSpheres exact(gas(10000, Vector3d(0, 0, -9.81)));
  const StepStats start = exact.measure();
  const auto clock = std::chrono::steady_clock::now();
  ASSERT_TRUE(exact.advance_to(1));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
  const std::int64_t events = exact.counts().pairs + exact.counts().planes;
  RecordProperty("collisions_per_second", static_cast<int>(static_cast<double>(events) / seconds));
  EXPECT_GT(events, 50000);
  const StepStats now = exact.measure();
  EXPECT_NEAR(now.energy(), start.energy(), 1e-12 * start.energy());
  EXPECT_LT(now.max_penetration, 1e-12);
  EXPECT_LT(deepest_overlap(exact), 1e-12);
  EXPECT_EQ(now.escaped, 0);
}

TEST(HardSphereGas, EndsAPileOfWhichAllEnergyIsAccountedFor) {
  HardSpheres exact(gas(100, Vector3d(0, 0, -9.81), 0.7));
  const StepStats start = exact.measure();
  EXPECT_FALSE(exact.advance_to(100));
  EXPECT_GT(exact.time(), 0.5);
  EXPECT_LT(exact.time(), 10);
  const StepStats now = exact.measure();
  EXPECT_LT(now.energy(), 0.8 * start.energy());
  EXPECT_NEAR(now.energy() + exact.dissipated(), start.energy(), 1e-12 * start.energy());
}

// ---- time-stepped gas ----

/// Distances in m from the exact motion, and from that of spheres that collide at the starts of steps.
struct GasErrors {
  std::vector<double> exact, early;
};

/// The largest distance after half a second of eight spheres in a box, for each number of steps. Geometric
/// mean of 20 scenes, since the error depends on how impacts fall into steps.
GasErrors errors_of_steps(const Vector3d& gravity, const std::vector<int>& steps_per_second) {
  const std::vector<double> none(steps_per_second.size(), 0);
  GasErrors errors{none, none};
  const int scenes = 20;
  for (std::uint32_t seed = 1; seed <= scenes; ++seed) {
    Uniform uniform{Random(seed)};
    Scene scene = hard_space(gravity);
    scene.box = Box{Vector3d(0, 0, 0), Vector3d(4, 4, 4)};
    scene.physics.substeps = 1;
    for (const double x : {1.0, 3.0})
      for (const double y : {1.0, 3.0})
        for (const double z : {1.0, 3.0})
          scene.bodies.push_back(
              sphere(uniform(0.5, 0.9), Vector3d(x, y, z) + uniform.vector(0.1), uniform.vector(2)));
    HardSpheres exact(scene);
    EXPECT_TRUE(exact.advance_to(0.5));
    EXPECT_GT(exact.counts().pairs + exact.counts().planes, 5);
    const std::vector<Vector3d> expected = exact.bodies().position;
    for (std::size_t k = 0; k < steps_per_second.size(); ++k) {
      scene.physics.time_step = TimeStep::per_second(steps_per_second[k]);
      RunOptions options;
      options.executor = ExecutorKind::cpu;
      options.cpu_threads = 1;
      World world(scene, options);
      world.step(steps_per_second[k] / 2);
      BruteSpheres early(scene, exact.initial(), 1.0L / steps_per_second[k]);
      early.advance_to(0.5);
      const std::vector<Vector3d> reached = world.bodies().position;
      double error = 0, other = 0;
      for (std::size_t i = 0; i < reached.size(); ++i) {
        error = std::max(error, (reached[i] - expected[i]).norm());
        other = std::max(other, (reached[i] - early.positions()[i].cast<double>()).norm());
      }
      errors.exact[k] += std::log(error) / scenes;
      errors.early[k] += std::log(other) / scenes;
    }
  }
  for (std::vector<double>* each : {&errors.exact, &errors.early})
    for (double& error : *each) error = std::exp(error);
  return errors;
}

TEST(HardSphereGas, IsWhatTheTimeSteppedGasConvergesToWithItsStep) {
  for (const Vector3d& gravity : {Vector3d(0, 0, 0), Vector3d(0, 0, -9.81)}) {
    const auto [errors, early] = errors_of_steps(gravity, {64, 128, 256, 512, 1024});
    for (std::size_t k = 1; k < errors.size(); ++k)
      EXPECT_LT(errors[k], errors[k - 1] / 1.5) << k;  // halved, up to the scatter of 20 scenes
    const double order = std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
    EXPECT_NEAR(order, 1, 0.15);  // an impact is about up to a step early
    // The times of impacts are the whole error. In most scenes only rounding remains; in the others, impacts
    // of one sphere in the same step are in another order, or a pair that touches a little more than a step
    // later is not yet in the list of contacts.
    for (std::size_t k = 0; k < errors.size(); ++k) EXPECT_LT(early[k], 1e-6 * errors[k]) << k;
  }
}

// 294 balls fill a fifth of the box. They have 417 impacts in 0.2 s, and many follow from others.
TEST(HardSphereGas, ADenseGasConvergesWithItsStep) {
  Scene scene = project_scene("hard/gas_20_percent");
  scene.physics.precision = Precision::f64;
  HardSpheres exact(scene);
  ASSERT_TRUE(exact.advance_to(0.2));
  EXPECT_GT(exact.counts().pairs, 100);
  const std::vector<Vector3d> expected = exact.bodies().position;
  for (const Solver solver : {Solver::soft_step, Solver::jacobi_split}) {
    scene.physics.solver = solver;
    std::vector<double> steps, errors;
    for (const int per_second : {15, 30, 60, 120, 240}) {  // with four substeps each
      scene.physics.time_step = TimeStep::per_second(per_second);
      RunOptions options;
      options.executor = ExecutorKind::cpu;
      options.cpu_threads = 1;
      World world(scene, options);
      world.step(per_second / 5);
      const std::vector<Vector3d> reached = world.bodies().position;
      double sum = 0;
      for (std::size_t i = 0; i < reached.size(); ++i) sum += (reached[i] - expected[i]).squaredNorm();
      steps.push_back(1.0 / per_second);
      errors.push_back(std::sqrt(sum / static_cast<double>(reached.size())));
      if (errors.size() > 1) {
        EXPECT_LT(errors.back(), errors[errors.size() - 2]) << per_second;
      }
    }
    EXPECT_NEAR(fitted_order(steps, errors), 1, 0.2) << name_of(solver_names, solver);
  }
}

}  // namespace
}  // namespace collidoscope
