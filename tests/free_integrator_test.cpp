// Tests integrators and rotation updates inside the solvers. Their orders are compared with closed forms.
// They must not change contacts, joints and resting bodies, and cost nothing if not selected.

#include "sim_cuda/solver/free_integrator.h"

#include <algorithm>

#include "sim_cuda/reference/free_rotation.h"
#include "sim_cuda/reference/kepler.h"
#include "sim_cuda/scene/names.h"
#include "tests/executors.h"
#include "tests/gravity.h"
#include "tests/order_of_error.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

constexpr Integrator euler = Integrator::semi_implicit_euler, verlet = Integrator::velocity_verlet,
                     rk4 = Integrator::rk4;
int order_of(Integrator integrator) { return integrator == rk4 ? 4 : integrator == verlet ? 2 : 1; }

class OfASolver : public testing::TestWithParam<std::tuple<ExecutorKind, Solver>> {
 protected:
  RunOptions options() const {
    RunOptions o;
    o.executor = std::get<0>(GetParam());
    return o;
  }
  Solver solver() const { return std::get<1>(GetParam()); }
  /// No box, no gravity, double; one substep per step.
  Scene space(Integrator integrator) const {
    Scene scene = empty_space();
    scene.physics.solver = solver();
    scene.physics.precision = Precision::f64;
    scene.physics.integrator = integrator;
    scene.physics.substeps = 1;
    return scene;
  }
  /// The state after `time` s in `steps` steps of two substeps each.
  BodyStates after(Scene scene, double time, int steps) const {
    scene.physics.substeps = 2;
    scene.physics.time_step = time / steps;
    World world(scene, options());
    world.step(steps);
    return world.bodies();
  }
};
std::string executor_and_solver(const testing::TestParamInfo<std::tuple<ExecutorKind, Solver>>& each) {
  return std::string(std::get<0>(each.param) == ExecutorKind::cuda ? "cuda_" : "cpu_") +
         std::string(name_of(solver_names, std::get<1>(each.param)));
}
class FreeMotions : public OfASolver {};
INSTANTIATE_TEST_SUITE_P(Executors, FreeMotions,
                         testing::Combine(testing::ValuesIn(executors()),
                                          testing::Values(Solver::impulse, Solver::soft_step,
                                                          Solver::jacobi_split)),
                         executor_and_solver);
/// The solver `impulse` has no attractors, joints and sleeping.
class SoftFreeMotions : public OfASolver {};
INSTANTIATE_TEST_SUITE_P(Executors, SoftFreeMotions,
                         testing::Combine(testing::ValuesIn(executors()),
                                          testing::Values(Solver::soft_step, Solver::jacobi_split)),
                         executor_and_solver);

TEST_P(FreeMotions, FlyAParabolaExactlyOrMissItByEulersBias) {
  for (const Integrator integrator : {euler, verlet, rk4})
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      Scene scene = space(integrator);
      scene.physics.precision = precision;
      scene.physics.gravity = Vector3d(0.5, 0, -g);
      scene.bodies = {sphere(1, Vector3d(1, 2, 300), Vector3d(3, -1, 4))};
      const int steps = 90;
      const double time = 3, h = time / steps / 2, bit = precision == Precision::f64 ? 1.2e-16 : 6e-8;
      const BodyStates s = after(scene, time, steps);
      const Vector3d bias =
          integrator == euler ? Vector3d(h * time / 2 * scene.physics.gravity) : Vector3d(0, 0, 0);
      const Vector3d exact =
          Vector3d(1, 2, 300) + time * Vector3d(3, -1, 4) + time * time / 2 * scene.physics.gravity;
      // Each substep rounds the increment and the sum once.
      EXPECT_LT((s.position[0] - exact - bias).norm(), 2 * steps * bit * 300);
      EXPECT_LT((s.velocity[0] - Vector3d(3, -1, 4) - time * scene.physics.gravity).norm(),
                2 * steps * bit * 30);
    }
}

TEST_P(FreeMotions, AreOfTheirOrderInAMedium) {
  for (const bool linear : {true, false})
    for (const Integrator integrator : {euler, verlet, rk4}) {
      Scene scene = space(integrator);
      scene.physics.drag = {.viscosity = linear ? 1.0 : 0.0, .density = linear ? 0.0 : 50.0};
      const double speed = 10, time = 2;
      scene.bodies = {sphere(0.1, Vector3d(0, 0, 0), Vector3d(0.6 * speed, 0, 0.8 * speed))};
      scene.bodies[0].mass = 2;
      const DragLaw<double> law = DragLaw<double>::of(scene.physics.drag);
      const double rate = law.decay(linear ? 1 : speed, 0.1, 0.5, 1);
      const double way =
          linear ? speed * -std::expm1(-rate * time) / rate : std::log1p(rate * time) / (rate / speed);
      const double left = linear ? speed * std::exp(-rate * time) : speed / (1 + rate * time);
      ASSERT_LT(left, 0.6 * speed);
      for (const bool of_speed : {true, false}) {
        const auto error = [&](int steps) {
          const BodyStates s = after(scene, time, steps);
          return std::abs(of_speed ? s.velocity[0].norm() - left : s.position[0].norm() - way);
        };
        if (integrator == verlet && !linear && of_speed)
          EXPECT_LT(error(16), 1e-13 * speed) << "this law alone is kicked exactly";
        else
          EXPECT_NEAR(order_of_error(error, 32), order_of(integrator), 0.15)
              << name_of(integrator_names, integrator) << (linear ? ", Stokes" : ", Newton");
      }
    }
}

TEST_P(SoftFreeMotions, AreOfTheirOrderOnASpringAndAnOrbit) {
  for (const Integrator integrator : {euler, verlet, rk4}) {
    // With a softening far beyond the amplitude, an attractor is a linear spring.
    Scene scene = space(integrator);
    const double omega = 1.2, eps = 1e6;
    scene.physics.attractors = {{.strength = omega * omega * eps * eps * eps, .softening = eps}};
    scene.bodies = {sphere(0.1, Vector3d(1, 0, 0), Vector3d(0, 0, omega))};
    EXPECT_NEAR(
        order_of_error(
            [&](int steps) {
              const double turn = omega * 1.7;
              return (after(scene, 1.7, steps).position[0] - Vector3d(std::cos(turn), 0, std::sin(turn)))
                  .norm();
            },
            16),
        order_of(integrator), 0.15)
        << name_of(integrator_names, integrator);

    // An orbit of eccentricity 0.3. Its radius is so large that the smallest softening is negligible.
    const double mu = 2, r = 1000, speed = std::sqrt(1.3 * mu / r);
    scene.physics.attractors = {{.strength = mu, .softening = 1e-3}};
    scene.bodies = {sphere(0.1, Vector3d(r, 0, 0), Vector3d(0, 0.8 * speed, 0.6 * speed))};
    const OrbitState start{scene.bodies[0].position, scene.bodies[0].velocity};
    const double time = 0.4 * kepler_period(mu, start);
    EXPECT_NEAR(
        order_of_error(
            [&](int steps) {
              return (after(scene, time, steps).position[0] - kepler_orbit(mu, start, time).position).norm();
            },
            100),
        order_of(integrator), 0.15)
        << name_of(integrator_names, integrator);
  }
}

TEST_P(FreeMotions, TurnBodiesToTheOrderOfTheirRotationUpdate) {
  for (const Integrator integrator : {euler, verlet, rk4})
    for (const RotationUpdate update : {RotationUpdate::first_order, RotationUpdate::lie_group}) {
      Scene scene = space(integrator);
      scene.physics.rotation_update = update;
      const int order = update == RotationUpdate::first_order ? 1 : integrator == rk4 ? 4 : 2;
      const double time = 1.5;
      const Vector3d top(2, 2, 1), spin(0.5, 0.3, 3), tumbler(1, 2, 2.5), tumble(0.9, 0, 1.2);
      scene.bodies = {sphere(0.1, Vector3d(0, 0, 0)), sphere(0.1, Vector3d(9, 0, 0))};
      scene.bodies[0].inertia = top;
      scene.bodies[0].angular_velocity = spin;
      scene.bodies[1].inertia = tumbler;
      scene.bodies[1].angular_velocity = tumble;
      const auto of_top = [&](int steps) {
        return after(scene, time, steps).orientation[0].angularDistance(symmetric_top(top, spin, time));
      };
      const auto of_tumbler = [&](int steps) {
        const BodyStates s = after(scene, time, steps);
        return (s.orientation[1].conjugate() * s.angular_velocity[1] -
                middle_axis_spin(tumbler, tumble, time))
            .norm();
      };
      const std::string what = std::string(name_of(integrator_names, integrator)) + ", " +
                               std::string(name_of(rotation_update_names, update));
      if (update == RotationUpdate::lie_group)
        EXPECT_LT(of_top(3), 1e-13) << what << " is exact";
      else
        EXPECT_NEAR(order_of_error(of_top, 48), order, 0.15) << what;
      EXPECT_NEAR(order_of_error(of_tumbler, update == RotationUpdate::lie_group ? 4 : 12), order, 0.15)
          << what;
    }
}

// ---- unaffected behaviour ----

TEST_P(FreeMotions, LeaveABodyAtRestWhereItIsToTheBit) {
  Scene scene = space(euler);
  scene.physics.gravity = Vector3d(0, 0, -g);
  scene.box = Box{};
  scene.bodies = {sphere(1, Vector3d(50, 50, 1))};
  std::vector<std::uint64_t> hashes;
  for (const Integrator integrator : {euler, verlet, rk4}) {
    scene.physics.integrator = integrator;
    World world(scene, options());
    world.step(300);
    hashes.push_back(world.state_hash());
  }
  EXPECT_EQ(hashes[1], hashes[0]);
  EXPECT_EQ(hashes[2], hashes[0]);
}

TEST_P(SoftFreeMotions, LeavePendulumsAndWhatRestsAsTheyAreToTheBit) {
  Scene scene = space(euler);
  scene.physics.substeps = 4;
  scene.physics.gravity = Vector3d(0, 0, -g);
  scene.materials[0].friction = 0.5;
  scene.materials[0].restitution = 0.2;
  scene.obstacles = {Plane{}};
  for (int k = 0; k < 5; ++k) scene.bodies.push_back(sphere(1, Vector3d(0, 0, 1 + 2 * k)));
  scene.bodies.push_back(sphere(0.5, Vector3d(7, 0, 8)));
  scene.joints.emplace_back();
  scene.joints[0].a = 5;
  scene.joints[0].anchor_b = Vector3d(5, 0, 10);
  World settled(scene, options());
  settled.step(200);
  const auto goes_on = [&](Integrator integrator, bool sleeps) {
    scene.physics.integrator = integrator;
    scene.physics.sleep.reset();
    if (sleeps) scene.physics.sleep = Sleep{};
    World world(scene, options());
    world.restore(settled);
    world.step(60);
    EXPECT_GT(world.bodies().velocity[5].norm(), 0.1);
    EXPECT_EQ(world.measure().asleep, sleeps ? 5 : 0);
    return world.state_hash();
  };
  for (const bool sleeps : {false, true}) {
    const std::uint64_t expected = goes_on(euler, sleeps);
    EXPECT_EQ(goes_on(verlet, sleeps), expected);
    EXPECT_EQ(goes_on(rk4, sleeps), expected);
  }
}

/// Largest overlap of two bodies in m. Light bodies under more than 100 times their mass are left out: one
/// iteration cannot carry them (assets/scenes/hard/heavy_on_light).
double deepest_overlap(World& world) {
  const std::vector<Vector3d> x = world.bodies().position;
  const std::vector<double>&m = world.initial().mass, &r = world.initial().radius;
  double deepest = 0;
  for (std::size_t a = 0; a < x.size(); ++a)
    for (std::size_t b = a + 1; b < x.size(); ++b)
      if (std::max(m[a], m[b]) < 100 * std::min(m[a], m[b]))
        deepest = std::max(deepest, r[a] + r[b] - (x[b] - x[a]).norm());
  return deepest;
}

TEST_P(SoftFreeMotions, LetAPileSettleAsDeep) {
  Scene scene = box_collider(200);
  scene.physics.solver = solver();
  scene.physics.precision = Precision::f64;
  scene.physics.iterations = solver() == Solver::jacobi_split ? 4 : 1;
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(50, 50, 100)};
  scene.materials[0].friction = 0.5;
  scene.materials[0].restitution = 0.2;
  std::vector<double> height;  // of the centre of mass, m
  for (const Integrator integrator : {euler, verlet, rk4}) {
    scene.physics.integrator = integrator;
    World world(scene, options());
    world.step(400);
    const StepStats stats = world.measure();
    EXPECT_EQ(stats.escaped, 0);
    double mass = 0;
    for (const double m : world.initial().mass) mass += m;
    height.push_back(stats.potential_energy / mass / g);
    EXPECT_LT(stats.kinetic_energy / mass / g, 0.002 * height[0]) << name_of(integrator_names, integrator);
    EXPECT_LT(deepest_overlap(world), 0.2);
  }
  EXPECT_NEAR(height[1], height[0], 0.05 * height[0]);
  EXPECT_NEAR(height[2], height[0], 0.05 * height[0]);
}

TEST_P(FreeMotions, BounceAsHighAsTheyShould) {
  // The ball drops 2 m onto a floor with restitution 0.8. The n-th peak is at 0.64^n of the height.
  double missed[3] = {};
  for (const Integrator integrator : {euler, verlet, rk4}) {
    Scene scene = space(integrator);
    scene.physics.gravity = Vector3d(0, 0, -g);
    scene.physics.restitution_threshold = 0;
    scene.physics.time_step = 1.0 / 240;
    scene.materials[0].restitution = 0.8;
    scene.obstacles = {Plane{}};
    scene.bodies = {sphere(1, Vector3d(0, 0, 3))};
    World world(scene, options());
    double before = 3, height = 2;
    bool rises = false;
    for (int k = 0; k < 720; ++k) {
      world.step();
      const double z = world.bodies().position[0].z();
      EXPECT_GE(z, 1 - 1e-12);
      if (rises && z < before) {
        height *= 0.64;
        double& worst = missed[static_cast<int>(integrator)];
        worst = std::max(worst, std::abs(before - 1 - height));
      }
      rises = z > before;
      before = z;
    }
    EXPECT_NEAR(height, 2 * 0.64 * 0.64 * 0.64, 1e-12) << "three peaks";
  }
  // With `impulse` bodies bounce early, before they reach the plane. With the other solvers the only error is
  // that of Euler's method on the way down.
  const bool early = solver() == Solver::impulse;
  EXPECT_GT(missed[0], 0.02);
  EXPECT_LT(missed[1], early ? 0.005 : 1e-4);
  EXPECT_LT(missed[2], early ? 0.005 : 1e-4);
}

TEST_P(FreeMotions, EnterNoCeiling) {
  for (const Integrator integrator : {euler, verlet, rk4}) {
    Scene scene = space(integrator);
    scene.physics.gravity = Vector3d(0, 0, -g);
    scene.box = Box{};
    for (int k = 0; k < 40; ++k)
      scene.bodies.push_back(sphere(0.5, Vector3d(2 + 2 * k, 50, 98.5), Vector3d(0, 0, 4 + 0.05 * k)));
    World world(scene, options());
    double highest = 0;
    for (int k = 0; k < 60; ++k) {
      world.step();
      for (const Vector3d& x : world.bodies().position) highest = std::max(highest, x.z());
    }
    EXPECT_GT(highest, 99.4);
    EXPECT_LE(highest, 99.5 + 1e-12);
  }
}

TEST_P(FreeMotions, WhatIsNotCalledForCostsNothing) {
  Scene scene = box_collider(100);
  scene.physics.solver = solver();
  scene.physics.substeps = 3;
  scene.physics.effects = Effects{.gravity = true, .rotation = true};
  const auto launches = [](const World& world, std::string_view stage) -> int {
    const RunTimes times = world.times();
    for (const StageTime& one : times.stages)
      if (one.name == stage) return one.launches;
    return 0;
  };
  World flying(scene, options());
  scene.physics.integrator = euler;
  World plain(scene, options());
  scene.physics.rotation_update = RotationUpdate::first_order;
  World paper(scene, options());
  scene.bodies = {sphere(1, Vector3d(0, 0, 0))};
  scene.bodies[0].inertia = Vector3d(1, 1, 2);
  World paper_turning(scene, options());
  scene.physics.rotation_update = RotationUpdate::lie_group;
  World turning(scene, options());
  scene.bodies[0].motion = Motion::kinematic;
  World kinematic(scene, options());
  for (World* world : {&plain, &flying, &paper, &paper_turning, &turning, &kinematic}) world->step(10);
  // With Euler's method, the other solvers copy the velocities of each move for the energy guard.
  const int copies = solver() == Solver::impulse ? 0 : 3;
  EXPECT_EQ(launches(plain, "integrate"), copies);
  EXPECT_EQ(launches(plain, "turn"), 0) << "all moments of inertia are equal";
  EXPECT_EQ(launches(flying, "integrate"), 2 * 3);
  EXPECT_EQ(launches(flying, "turn"), 0);
  EXPECT_EQ(launches(paper, "turn"), 0);
  EXPECT_EQ(launches(turning, "integrate"), copies);
  EXPECT_EQ(launches(turning, "turn"), 3);
  EXPECT_EQ(launches(paper_turning, "turn"), 3);
  EXPECT_EQ(launches(kinematic, "turn"), 0);
  // Two velocities of each body, and a byte of it for the energy guard.
  EXPECT_EQ(flying.info().allocated_bytes - plain.info().allocated_bytes,
            100 * (2 * 16 + (copies > 0 ? 1 : 0)));
  EXPECT_EQ(turning.info().allocated_bytes, paper_turning.info().allocated_bytes);
}

// ---- invariants ----

TEST_P(SoftFreeMotions, VerletKeepsTheEnergyOfAnOrbitBounded) {
  Scene scene = space(verlet);
  const double mu = 1000, r = 10, speed = std::sqrt(1.3 * mu / r);
  scene.physics.attractors = {{.strength = mu, .softening = 0.1}};
  scene.bodies = {sphere(0.1, Vector3d(r, 0, 0), Vector3d(0, speed, 0))};
  const double period = kepler_period(mu, {scene.bodies[0].position, scene.bodies[0].velocity});
  constexpr int steps = 100, turns = 200;
  scene.physics.time_step = period / steps;
  World world(scene, options());
  const double start = world.measure().energy();
  double first = 0, last = 0;
  for (int turn = 0; turn < turns; ++turn) {
    if (turn >= 5 && turn < turns - 5) {
      world.step(steps);
      continue;
    }
    double& worst = turn < 5 ? first : last;
    for (int k = 0; k < steps; k += 4) {
      world.step(4);
      worst = std::max(worst, std::abs(world.measure().energy() / start - 1));
    }
  }
  EXPECT_GT(first, 1e-6);
  EXPECT_LT(last, 1.1 * first);
}

}  // namespace
}  // namespace collidoscope
