// Tests the closed forms that serve as reference solutions. They are checked by identities independent of
// their derivation: equations of motion by finite differences, conserved quantities and limits.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <type_traits>

#include "sim_cuda/reference/drag_solution.h"
#include "sim_cuda/reference/free_rotation.h"
#include "sim_cuda/reference/impacts.h"
#include "sim_cuda/reference/jacobi_elliptic.h"
#include "sim_cuda/reference/kepler.h"
#include "sim_cuda/reference/oscillations.h"

namespace collidoscope {
namespace {

constexpr double pi = std::numbers::pi;

/// The derivative at t by finite differences. The error is about 1e-10 for functions with a time scale of a
/// second.
template <class F>
auto slope(const F& f, double t) {
  const double h = 1e-3;
  return std::invoke_result_t<F, double>((8 * (f(t + h) - f(t - h)) - (f(t + 2 * h) - f(t - 2 * h))) /
                                         (12 * h));
}

TEST(JacobiElliptic, KeepsItsIdentitiesAndDerivatives) {
  for (const double m : {0.0, 0.01, 0.5, 0.9, 0.999, 1 - 1e-9})
    for (double u = -9; u < 9; u += 0.37) {
      const JacobiElliptic e = jacobi_elliptic(u, m);
      EXPECT_NEAR(e.sn * e.sn + e.cn * e.cn, 1, 1e-14);
      EXPECT_NEAR(e.dn * e.dn + m * e.sn * e.sn, 1, 1e-13) << u << ' ' << m;
      const double d_sn = slope([&](double x) { return jacobi_elliptic(x, m).sn; }, u);
      const double d_cn = slope([&](double x) { return jacobi_elliptic(x, m).cn; }, u);
      const double d_dn = slope([&](double x) { return jacobi_elliptic(x, m).dn; }, u);
      EXPECT_NEAR(d_sn, e.cn * e.dn, 1e-10) << u << ' ' << m;
      EXPECT_NEAR(d_cn, -e.sn * e.dn, 1e-10) << u << ' ' << m;
      EXPECT_NEAR(d_dn, -m * e.sn * e.cn, 1e-10) << u << ' ' << m;
    }
}

TEST(JacobiElliptic, IsTheSineAtOneEndAndTheHyperbolicTangentAtTheOther) {
  for (double u = -3; u < 3; u += 0.1) {
    EXPECT_NEAR(jacobi_elliptic(u, 0).sn, std::sin(u), 1e-15);
    EXPECT_NEAR(jacobi_elliptic(u, 1 - 1e-14).sn, std::tanh(u), 1e-11);
  }
  for (const double m : {0.0, 0.3, 0.7, 0.99}) {
    // K by numerical integration. The trapezoidal rule converges exponentially for periodic functions.
    double sum = 0;
    for (int k = 0; k < 4000; ++k) sum += 1 / std::sqrt(1 - m * std::pow(std::sin((k + 0.5) * pi / 4000), 2));
    EXPECT_NEAR(complete_elliptic(m), sum / 4000 * pi / 2, 1e-12);
    EXPECT_NEAR(jacobi_elliptic(complete_elliptic(m), m).sn, 1, 1e-15);
    EXPECT_NEAR(jacobi_elliptic(complete_elliptic(m), m).cn, 0, 1e-14);
  }
}

TEST(Oscillations, ObeyTheirEquations) {
  for (const double z : {0.0, 0.1, 0.7, 1.0, 3.0})
    for (double t = 0.1; t < 3; t += 0.3) {
      const double w = 2.5;
      const auto at = [&](double s) { return damped_oscillation(w, z, s); };
      EXPECT_NEAR(slope([&](double s) { return at(s).at; }, t), at(t).rate, 1e-8);
      EXPECT_NEAR(slope([&](double s) { return at(s).rate; }, t), -w * w * at(t).at - 2 * z * w * at(t).rate,
                  1e-7);
      EXPECT_EQ(at(0).at, 1);
      EXPECT_EQ(at(0).rate, 0);
    }
}

TEST(Oscillations, ThePendulumKeepsItsEnergyAndSwingsByItsEquation) {
  const double w = 3.1;
  for (const double amplitude : {1e-3, 0.5, 1.5, 2.498, 3.1, -1.0}) {
    EXPECT_NEAR(pendulum(w, amplitude, 0).at, amplitude, 1e-12);
    for (double t = 0.05; t < 4; t += 0.2) {
      const Oscillation p = pendulum(w, amplitude, t);
      EXPECT_NEAR(p.rate * p.rate / 2 - w * w * std::cos(p.at), -w * w * std::cos(amplitude), 1e-11);
      EXPECT_NEAR(slope([&](double s) { return pendulum(w, amplitude, s).at; }, t), p.rate, 1e-8);
      EXPECT_NEAR(slope([&](double s) { return pendulum(w, amplitude, s).rate; }, t), -w * w * std::sin(p.at),
                  1e-7);
      EXPECT_NEAR(pendulum(w, amplitude, t + pendulum_period(w, amplitude)).at, p.at, 1e-11);
    }
  }
  EXPECT_NEAR(pendulum_period(w, 1e-4) * w / (2 * pi), 1 + 1e-8 / 16, 1e-14) << "1 + amplitude^2/16";
  for (double t = 0; t < 5; t += 0.1)
    EXPECT_NEAR(pendulum(w, 1e-5, t).at, 1e-5 * std::cos(w * t), 1e-14) << "small, it is a spring";
}

TEST(Kepler, KeepsEnergyMomentumAndPeriodAndFallsByTheLawOfSquares) {
  const double mu = 7;
  for (const double share : {0.2, 0.9, 1.0, 1.3}) {
    const OrbitState start{Vector3d(1, 2, -0.5), std::sqrt(mu / 5) * share * Vector3d(0.3, 0.4, 1.2)};
    const auto energy = [&](const OrbitState& s) {
      return s.velocity.squaredNorm() / 2 - mu / s.position.norm();
    };
    ASSERT_LT(energy(start), 0);
    const double period = kepler_period(mu, start);
    for (double t = 0; t < 2 * period; t += period / 17) {
      const OrbitState s = kepler_orbit(mu, start, t);
      EXPECT_NEAR(energy(s) / energy(start), 1, 1e-12);
      EXPECT_LT((s.position.cross(s.velocity) - start.position.cross(start.velocity)).norm(), 1e-12);
      EXPECT_LT((kepler_orbit(mu, start, t + period).position - s.position).norm(), 1e-11);
      const double r = s.position.norm();
      if (r < 1) continue;  // finite differences are too coarse at high speed
      EXPECT_LT((slope([&](double q) { return kepler_orbit(mu, start, q).position; }, t) - s.velocity).norm(),
                1e-7);
      EXPECT_LT((slope([&](double q) { return kepler_orbit(mu, start, q).velocity; }, t) +
                 mu / (r * r * r) * s.position)
                    .norm(),
                1e-7);
    }
  }
}

TEST(FreeRotation, OfASymmetricTopKeepsLAndTurnsByItsAngularVelocity) {
  const Vector3d inertia(2, 2, 1), spin(0.5, 0, 3), momentum = inertia.cwiseProduct(spin);
  for (double t = 0; t < 4; t += 0.1) {
    const Quaterniond q = symmetric_top(inertia, spin, t);
    const Quaterniond rate(Eigen::Vector4d(
        slope([&](double s) { return Eigen::Vector4d(symmetric_top(inertia, spin, s).coeffs()); }, t)));
    const Vector3d turning = 2 * (rate * q.conjugate()).vec();  // in world axes
    const Vector3d in_body = q.conjugate() * turning;
    EXPECT_LT((q * inertia.cwiseProduct(in_body) - momentum).norm(), 1e-7) << t;
  }
}

TEST(FreeRotation, AboutTheMiddleAxisObeysEulersEquations) {
  const Vector3d inertia(1, 2, 3);
  for (const Vector3d& spin : {Vector3d(1.7, 0, 1), Vector3d(1e-3, 0, 2), Vector3d(1.73, 0, 1)}) {
    const auto at = [&](double t) { return middle_axis_spin(inertia, spin, t); };
    EXPECT_LT((at(0) - spin).norm(), 1e-15);
    for (double t = 0; t < 12; t += 0.25) {
      const Vector3d w = at(t), moment = inertia.cwiseProduct(w);
      const Vector3d rate = slope(at, t);
      EXPECT_LT((inertia.cwiseProduct(rate) + w.cross(moment)).norm(), 1e-8) << t;
      EXPECT_NEAR(moment.squaredNorm(), inertia.cwiseProduct(spin).squaredNorm(), 1e-11);
      EXPECT_NEAR(w.dot(moment), spin.dot(inertia.cwiseProduct(spin)), 1e-12);
    }
  }
}

TEST(Impacts, KeepWhatTheyShould) {
  const Vector3d n(0.6, 0, 0.8);
  const TwoVelocities before{Vector3d(3, 1, 2), Vector3d(-1, 0, 0.5)};
  for (const double e : {0.0, 0.5, 1.0}) {
    const TwoVelocities after = after_impact(2, 5, before, n, e);
    EXPECT_LT((2 * (after.a - before.a) + 5 * (after.b - before.b)).norm(), 1e-14);
    EXPECT_NEAR((after.b - after.a).dot(n), e * (before.a - before.b).dot(n), 1e-14);
    EXPECT_LT((after.a - before.a).cross(n).norm(), 1e-14);
    const double lost = 2 * (before.a.squaredNorm() - after.a.squaredNorm()) +
                        5 * (before.b.squaredNorm() - after.b.squaredNorm());
    EXPECT_NEAR(lost, 10.0 / 7 * (1 - e * e) * std::pow((before.a - before.b).dot(n), 2), 1e-13);
  }
  const double r = 0.5;
  for (const double mu : {0.05, 0.2, 10.0}) {
    const Motion3 thrown{Vector3d(2, -1, -4), Vector3d(3, 20, -5)};
    const Motion3 up = after_bounce(thrown, r, Vector3d(0, 0, 1), 0.7, mu);
    const auto about_contact = [&](const Motion3& m) {  // per unit mass
      return Vector3d(0.4 * r * r * m.spin + r * Vector3d(0, 0, 1).cross(m.velocity));
    };
    EXPECT_LT((about_contact(up) - about_contact(thrown)).norm(), 1e-13);
    EXPECT_NEAR(up.velocity.z(), 2.8, 1e-14);
    const Vector3d change = up.velocity - thrown.velocity, across(change.x(), change.y(), 0);
    const Vector3d slip = up.velocity - r * up.spin.cross(Vector3d(0, 0, 1));
    if (mu > 1) {
      EXPECT_LT(Vector3d(slip.x(), slip.y(), 0).norm(), 1e-13) << "it grips";
    } else {
      EXPECT_NEAR(across.norm(), mu * change.z(), 1e-13) << "Coulomb's cone";
    }
  }
}

TEST(Rebounds, AreParabolasThatEndAtZenosPoint) {
  const Rebounds ball{9.81, 1.25, 0.5};
  EXPECT_NEAR(ball.time(60), ball.zeno_time(), 1e-15);
  for (int n = 1; n < 6; ++n) {
    EXPECT_NEAR(ball.height(ball.time(n)), 0, 1e-14);
    const double top = (ball.time(n) + ball.time(n + 1)) / 2;
    EXPECT_NEAR(ball.height(top), 1.25 * std::pow(0.25, n), 1e-14) << "e^2 of the height before";
  }
}

TEST(SlideToRoll, EndsWhereTheSurfaceIsAtRest) {
  const SlideToRoll ball{7, 0.3 * 9.81};
  const double t = ball.rolling_at(), spun = 2.5 * ball.deceleration * t;  // r w
  EXPECT_NEAR(7 - ball.deceleration * t, spun, 1e-14);
  EXPECT_NEAR(spun, 5.0, 1e-14) << "5/7 of 7 m/s";
  for (double s = 0.05; s < 2; s += 0.1)
    if (std::abs(s - t) > 0.01) {
      EXPECT_NEAR(slope([&](double q) { return ball.distance(q); }, s), s < t ? 7 - ball.deceleration * s : 5,
                  1e-9);
    }
  EXPECT_NEAR(down_slope(9.81, 0.6, 0.8, 2.0 / 7 * 0.75), 5.0 / 7 * 9.81 * 0.6, 1e-13);
  EXPECT_NEAR(down_slope(9.81, 0.6, 0.8, 2.0 / 7 * 0.75 - 1e-12), 5.0 / 7 * 9.81 * 0.6, 1e-10)
      << "sliding meets rolling";
  EXPECT_NEAR(down_slope(9.81, 0.6, 0.8, 0.5, 2.0 / 3), 0.6 * 9.81 * 0.6, 1e-13) << "a hollow sphere";
}

TEST(SlideToRoll, BackspinBringsTheBallBack) {
  const SlideToRoll ball{5, 0.5 * 9.81, -15};
  const double t = ball.rolling_at();
  EXPECT_NEAR(5 - ball.deceleration * t, -5.0 / 7, 1e-14);
  EXPECT_NEAR(5 - ball.deceleration * t, -15 + 2.5 * ball.deceleration * t, 1e-14)
      << "the surface is at rest";
  EXPECT_NEAR(slope([&](double q) { return ball.distance(q); }, t + 1), -5.0 / 7, 1e-9);
}

TEST(DragSolution, ObeysItsLawAndItsLimits) {
  for (const double a : {0.0, 1e-9, 0.7})
    for (const double b : {0.0, 0.3}) {
      if (a == 0 && b == 0) continue;
      const DragSolution law{a, b};
      EXPECT_EQ(law.speed(4, 0), 4);
      for (double t = 0.1; t < 5; t += 0.3)
        EXPECT_NEAR(slope([&](double s) { return law.speed(4, s); }, t), law.rate(law.speed(4, t)), 1e-9);
    }
  EXPECT_NEAR((DragSolution{1e-12, 0.3}.speed(4, 2)), (DragSolution{0, 0.3}.speed(4, 2)), 1e-11);
}

}  // namespace
}  // namespace collidoscope
