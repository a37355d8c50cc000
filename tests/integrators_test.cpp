// Tests integrators and rotation updates alone: their orders against closed forms, and invariants. A wrong
// coefficient must change the order. free_integrator_test.cpp tests them in the solvers.

#include "sim_cuda/dynamics/integrators.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/move.h"
#include "sim_cuda/dynamics/rotation_updates.h"
#include "sim_cuda/reference/free_rotation.h"
#include "tests/gravity.h"
#include "tests/order_of_error.h"

namespace collidoscope {
namespace {

/// The order for a mass on a spring after 2 s. `fly` makes one step.
template <class Fly>
double spring_order(const Fly& fly) {
  const double eps = 1e6;
  const PointAttractor<double> center{Vector3d(0, 0, 0), eps * eps * eps, eps};  // 1 rad/s
  const SmoothForces<double> forces{
      AttractorView<double>{&center, 1}, DragLaw<double>{}, false, Vector3d(0, 0, 0), 1, 1};
  return order_of_error(
      [&](int steps) {
        Vector3d x(1, 0, 0), v(0, 0.5, 0);
        const double h = 2.0 / steps;
        for (int k = 0; k < steps; ++k) {
          const FreeStep<double> step = fly(forces, x, v, forces.field(x), h);
          x += h * step.drift_velocity;
          v = step.velocity;
        }
        return (x - Vector3d(std::cos(2), 0.5 * std::sin(2), 0)).norm();
      },
      16);
}
template <class Kicks>
double verlet_order() {
  return spring_order([](const auto&... all) { return verlet_step<Kicks>(all...); });
}
template <class Tableau>
double rk4_order() {
  return spring_order([](const auto&... all) { return rk4_step<Tableau>(all...); });
}
/// The order for an asymmetric body after 1.5 s. `turn` makes one step.
template <class Turn>
double turning_order(const Turn& turn, int first_steps) {
  const Vector3d inertia(1, 2, 2.5), spin(0.9, 0, 1.2);
  return order_of_error(
      [&](int steps) {
        Quaterniond q(1, 0, 0, 0);
        Vector3d w = spin;
        for (int k = 0; k < steps; ++k) turn(q, w, inertia, 1.5 / steps);
        return (q.conjugate() * w - middle_axis_spin(inertia, spin, 1.5)).norm();
      },
      first_steps);
}
template <class Parts>
double lie_order(const Parts& parts) {
  return turning_order(
      [&](auto& q, auto& w, const Vector3d& inertia, double h) { rotate_lie_group(q, w, inertia, h, parts); },
      8);
}
/// The order of Euler's method on a parabola, with a relative error in each of its two coefficients.
double euler_order(double wrong_acceleration, double wrong_step) {
  return order_of_error(
      [&](int steps) {
        Vector3d x(0, 0, 0);
        PackedVector3<double> v(Vector3d(3, 0, 4));
        BodyView<double> bodies{};
        bodies.position = &x;
        bodies.velocity = &v;
        const StepControl control{};
        const MoveBodies<double> move{bodies,
                                      wrong_acceleration * Vector3d(0, 0, -g),
                                      {},
                                      {},
                                      wrong_step * 2 / steps,
                                      {},
                                      true,
                                      false,
                                      false,
                                      &control};
        for (int k = 0; k < steps; ++k) move(0);
        return (x - Vector3d(6, 0, 8 - 2 * g)).norm();
      },
      16);
}

constexpr double off = 1.1;
template <int which>
struct WrongKicks {
  static constexpr double first = which == 0 ? off * 0.5 : 0.5, second = which == 1 ? off * 0.5 : 0.5;
};
template <int which>
struct WrongTableau : RungeKutta4 {
  static constexpr double at(int stage) { return (stage == which ? off : 1) * RungeKutta4::at(stage); }
  static constexpr double weight(int stage) {
    return (stage + 4 == which ? off : 1) * RungeKutta4::weight(stage);
  }
};
struct WrongParts : RotationParts {
  int which = 0;
  double share(int part) const { return (part == which ? off : 1) * RotationParts::share(part); }
};

TEST(Integrators, AreOfTheirOrderAndNoWrongCoefficientIs) {
  constexpr double near = 0.15;
  EXPECT_NEAR(euler_order(1, 1), 1, near);
  EXPECT_LT(euler_order(off, 1), 1 - near);
  EXPECT_LT(euler_order(1, off), 1 - near);

  EXPECT_NEAR(verlet_order<VelocityVerlet>(), 2, near);
  EXPECT_LT(verlet_order<WrongKicks<0>>(), 2 - near);
  EXPECT_LT(verlet_order<WrongKicks<1>>(), 2 - near);

  EXPECT_NEAR(rk4_order<RungeKutta4>(), 4, near);
  for (const double order :
       {rk4_order<WrongTableau<1>>(), rk4_order<WrongTableau<2>>(), rk4_order<WrongTableau<3>>(),
        rk4_order<WrongTableau<4>>(), rk4_order<WrongTableau<5>>(), rk4_order<WrongTableau<6>>(),
        rk4_order<WrongTableau<7>>()})
    EXPECT_LT(order, 4 - near);

  const auto paper = [](double wrong) {
    return turning_order([&](auto& q, auto& w, const Vector3d& inertia,
                             double h) { rotate_first_order<double>(q, w, inertia, wrong * h); },
                         24);
  };
  EXPECT_NEAR(paper(1), 1, near);
  EXPECT_LT(paper(off), 1 - near);

  EXPECT_NEAR(lie_order(RotationParts{1}), 2, near);
  EXPECT_LT(lie_order(WrongParts{{1}, 0}), 2 - near);
  EXPECT_NEAR(lie_order(RotationParts{5}), 4, near);
  for (int part = 0; part < 5; ++part) EXPECT_LT(lie_order(WrongParts{{5}, part}), 4 - near) << part;
}

TEST(Integrators, KeepAngularMomentumAndEnergyOfATumbler) {
  const Vector3d inertia(1, 2, 3), spin(1e-3, 2, 0);
  const Vector3d momentum = Vector3d(inertia.array() * spin.array());
  const double energy = momentum.dot(spin) / 2;
  for (const int parts : {1, 5}) {
    Quaterniond q(1, 0, 0, 0);
    Vector3d w = spin;
    double worst = 0;
    bool flipped = false;
    constexpr int steps = 20000;
    for (int k = 0; k < steps; ++k) {
      rotate_lie_group(q, w, inertia, 0.02, RotationParts{parts});
      worst = std::max(worst, std::abs(momentum.dot(w) / 2 / energy - 1));
      flipped = flipped || (q.conjugate() * w).y() < -1.9;
    }
    EXPECT_TRUE(flipped);
    EXPECT_LT(worst, 5e-16 * steps);
    const Vector3d now = q * Vector3d(inertia.array() * (q.conjugate() * w).array());
    EXPECT_LT((now - momentum).norm(), 5e-16 * steps * momentum.norm());
    EXPECT_NEAR(q.norm(), 1, 1e-15);
  }
}

TEST(Integrators, TurnAnythingHoweverFast) {
  Quaternionf q(1, 0, 0, 0);
  Vector3d w(1e9, -1e9, 1e9);
  for (int k = 0; k < 10; ++k) rotate_lie_group(q, w, Vector3f(1, 2, 2.5), 1000.0f, RotationParts{5});
  EXPECT_NEAR(q.norm(), 1, 1e-6);
  EXPECT_TRUE(std::isfinite(w.norm()));
}

}  // namespace
}  // namespace collidoscope
