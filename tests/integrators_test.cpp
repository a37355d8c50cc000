// Integrators and rotation updates: the order of each against closed forms, in the solvers and outside of
// them; what a wrong coefficient makes of it; invariants; that contacts, joints and rest do not notice; and
// that the default costs what it did.

#include "sim_cuda/dynamics/integrators.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "sim_cuda/dynamics/move.h"
#include "sim_cuda/dynamics/rotation_updates.h"
#include "sim_cuda/reference/free_rotation.h"
#include "sim_cuda/reference/kepler.h"
#include "sim_cuda/scene/names.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

constexpr double g = 9.81;
constexpr Integrator euler = Integrator::semi_implicit_euler, verlet = Integrator::velocity_verlet,
                     rk4 = Integrator::rk4;
int order_of(Integrator integrator) { return integrator == rk4 ? 4 : integrator == verlet ? 2 : 1; }

/// The slope of log error over log step, from a run of `first` steps to one of 8 times as many.
double fitted_order(const std::function<double(int)>& error, int first) {
  return std::log2(error(first) / error(8 * first)) / 3;
}

// ---- in the solvers ----

class OfASolver : public testing::TestWithParam<std::tuple<ExecutorKind, Solver>> {
 protected:
  RunOptions options() const {
    RunOptions o;
    o.executor = std::get<0>(GetParam());
    return o;
  }
  Solver solver() const { return std::get<1>(GetParam()); }
  /// No box, no gravity, double, whole steps.
  Scene space(Integrator integrator) const {
    Scene scene = empty_space();
    scene.physics.solver = solver();
    scene.physics.precision = Precision::f64;
    scene.physics.integrator = integrator;
    scene.physics.substeps = 1;
    return scene;
  }
  /// `scene` after `time` s in so many steps, two substeps each.
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
class Integrators : public OfASolver {};
INSTANTIATE_TEST_SUITE_P(Executors, Integrators,
                         testing::Combine(testing::ValuesIn(executors()),
                                          testing::Values(Solver::impulse, Solver::soft_step,
                                                          Solver::jacobi_split)),
                         executor_and_solver);
/// `impulse` has no attractors, joints and sleep.
class SoftIntegrators : public OfASolver {};
INSTANTIATE_TEST_SUITE_P(Executors, SoftIntegrators,
                         testing::Combine(testing::ValuesIn(executors()),
                                          testing::Values(Solver::soft_step, Solver::jacobi_split)),
                         executor_and_solver);

TEST_P(Integrators, FlyAParabolaExactlyOrMissItByEulersBias) {
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
      // Each substep may round once what it adds, and once the sum.
      EXPECT_LT((s.position[0] - exact - bias).norm(), 2 * steps * bit * 300);
      EXPECT_LT((s.velocity[0] - Vector3d(3, -1, 4) - time * scene.physics.gravity).norm(),
                2 * steps * bit * 30);
    }
}

TEST_P(Integrators, AreOfTheirOrderInAMedium) {
  for (const bool linear : {true, false})
    for (const Integrator integrator : {euler, verlet, rk4}) {
      Scene scene = space(integrator);
      scene.physics.drag = {.viscosity = linear ? 1.0 : 0.0, .density = linear ? 0.0 : 50.0};
      const double speed = 10, time = 2;
      scene.bodies = {sphere(0.1, Vector3d(0, 0, 0), Vector3d(0.6 * speed, 0, 0.8 * speed))};
      scene.bodies[0].mass = 2;
      const DragLaw<double> law = DragLaw<double>::of(scene.physics.drag);
      const double rate = law.rate(linear ? 1 : speed, 0.1, 0.5, 1);
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
          EXPECT_NEAR(fitted_order(error, 32), order_of(integrator), 0.15)
              << name_of(integrator_names, integrator) << (linear ? ", Stokes" : ", Newton");
      }
    }
}

TEST_P(SoftIntegrators, AreOfTheirOrderOnASpringAndAnOrbit) {
  for (const Integrator integrator : {euler, verlet, rk4}) {
    // Softened far beyond the amplitude, an attractor is a spring.
    Scene scene = space(integrator);
    const double omega = 1.2, eps = 1e6;
    scene.physics.attractors = {{.strength = omega * omega * eps * eps * eps, .softening = eps}};
    scene.bodies = {sphere(0.1, Vector3d(1, 0, 0), Vector3d(0, 0, omega))};
    EXPECT_NEAR(
        fitted_order(
            [&](int steps) {
              const double turn = omega * 1.7;
              return (after(scene, 1.7, steps).position[0] - Vector3d(std::cos(turn), 0, std::sin(turn)))
                  .norm();
            },
            16),
        order_of(integrator), 0.15)
        << name_of(integrator_names, integrator);

    // An orbit of eccentricity 0.3, so wide that the least softening is none.
    const double mu = 2, r = 1000, speed = std::sqrt(1.3 * mu / r);
    scene.physics.attractors = {{.strength = mu, .softening = 1e-3}};
    scene.bodies = {sphere(0.1, Vector3d(r, 0, 0), Vector3d(0, 0.8 * speed, 0.6 * speed))};
    const OrbitState start{scene.bodies[0].position, scene.bodies[0].velocity};
    const double time = 0.4 * kepler_period(mu, start);
    EXPECT_NEAR(
        fitted_order(
            [&](int steps) {
              return (after(scene, time, steps).position[0] - kepler_orbit(mu, start, time).position).norm();
            },
            100),
        order_of(integrator), 0.15)
        << name_of(integrator_names, integrator);
  }
}

TEST_P(Integrators, TurnBodiesToTheOrderOfTheirRotationUpdate) {
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
      EXPECT_NEAR(fitted_order(of_top, 48), order, 0.15) << what;
      EXPECT_NEAR(fitted_order(of_tumbler, 12), order, 0.15) << what;
    }
}

}  // namespace
}  // namespace collidoscope
