// Tests leading error terms against values by hand and against runs of the methods.

#include "sim_cuda/reference/leading_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim_cuda/reference/kepler.h"

namespace collidoscope {
namespace {

SmoothState state(std::initializer_list<double> values) {
  SmoothState y(static_cast<Eigen::Index>(values.size()));
  Eigen::Index k = 0;
  for (const double value : values) y[k++] = value;
  return y;
}

TEST(LeadingError, OfAFallIsEulersBias) {
  const Rate pull = [](const SmoothState&) { return state({-9.81}); };
  const SmoothProblem fall{second_order_rate(pull),
                           [](double t) {
                             return state({5 * t - 4.905 * t * t, 5 - 9.81 * t});
                           },
                           1};
  const SmoothState e = leading_error(fall, euler_step(pull), 1, 2);
  EXPECT_NEAR(e[0], -9.81 * 2 / 2, 1e-3) << "g t / 2";
  EXPECT_NEAR(e[1], 0, 1e-3);
}

TEST(LeadingError, OfASpringIsKnownToAllThree) {
  const double w = 5, t = 1.5;
  const Rate pull = [=](const SmoothState& x) { return SmoothState(-w * w * x); };
  const SmoothProblem spring{second_order_rate(pull),
                             [=](double s) {
                               return state({std::cos(w * s), -w * std::sin(w * s)});
                             },
                             w};
  const SmoothState euler = leading_error(spring, euler_step(pull), 1, t);
  EXPECT_NEAR(euler[0], -w / 2 * std::sin(w * t), 0.01 * w) << "half a kick ahead, half a kick late";
  EXPECT_NEAR(euler[1], 0, 0.01 * w * w);
  // Verlet's frequency is too high by the factor (w h)^2 / 24, and its maximum speed is too low by (w h)^2 /
  // 8.
  const SmoothState verlet = leading_error(spring, verlet_step(pull), 2, t);
  EXPECT_NEAR(verlet[0], -std::sin(w * t) * w * t * w * w / 24, 0.01 * w * w);
  EXPECT_NEAR(verlet[1], -w * std::cos(w * t) * w * t * w * w / 24 + w * w * w / 8 * std::sin(w * t),
              0.01 * w * w * w);
  const SmoothState rk4 = leading_error(spring, rk4_step(spring.rate), 4, t);
  EXPECT_NEAR(std::hypot(rk4[0], rk4[1] / w), std::pow(w, 5) * t / 120, 0.01 * std::pow(w, 5) * t / 120);
}

TEST(LeadingError, OfSlowingIsKnownToo) {
  const double k = 0.7, v0 = 4, t = 2, s = 1 + k * v0 * t;
  const Rate rate = [=](const SmoothState& v) { return state({-k * v[0] * v[0]}); };
  const SmoothProblem slowing{rate, [=](double q) { return state({v0 / (1 + k * v0 * q)}); }, k * v0};
  const double v = v0 / s;
  const OneStep implicit_euler = [=](const SmoothState& y, double h) {
    return state({2 * y[0] / (1 + std::sqrt(1 + 4 * h * k * y[0]))});
  };
  EXPECT_NEAR(leading_error(slowing, implicit_euler, 1, t)[0], k * v * v * std::log(s), 1e-3 * k * v * v);
  EXPECT_NEAR(leading_error(slowing, rk4_step(rate), 4, t)[0] /
                  (std::pow(k * v0, 4) / v0 * v * v * (1 - std::pow(s, -3)) / 72),
              1, 0.02);
}

TEST(LeadingError, IsWhatTheMethodsComeToOnAnOrbit) {
  const double mu = 2;
  const OrbitState start{Vector3d(1, 0, 0), Vector3d(0, 1.1 * std::sqrt(mu), 0.2)};
  const Rate pull = [=](const SmoothState& x) { return SmoothState(-mu / std::pow(x.norm(), 3) * x); };
  const auto exact = [=](double t) {
    const OrbitState s = kepler_orbit(mu, start, t);
    SmoothState y(6);
    y << s.position, s.velocity;
    return y;
  };
  const SmoothProblem orbit{second_order_rate(pull), exact, 1.5};
  const double t = 4;
  const OneStep steps[] = {euler_step(pull), verlet_step(pull), rk4_step(orbit.rate)};
  const int orders[] = {1, 2, 4}, counts[] = {20000, 2000, 1000};
  for (int k = 0; k < 3; ++k) {
    SmoothState y = exact(0);
    const double h = t / counts[k];
    for (int n = 0; n < counts[k]; ++n) y = steps[k](y, h);
    const SmoothState expected = leading_error(orbit, steps[k], orders[k], t);
    EXPECT_LT(((y - exact(t)) / std::pow(h, orders[k]) - expected).norm(), 0.03 * expected.norm()) << k;
  }
}

}  // namespace
}  // namespace collidoscope
