#include "sim_cuda/reference/leading_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collidoscope {
namespace {

/// The state (x, v).
SmoothState joined_state(const SmoothState& x, const SmoothState& v) {
  SmoothState y(x.size() + v.size());
  y << x, v;
  return y;
}

}  // namespace

SmoothState leading_error(const SmoothProblem& problem, const OneStep& step, int order, double time) {
  // Step for the estimate of d: short, but limited by rounding, which is divided by h^(p+1).
  const double h = std::pow(std::numeric_limits<double>::epsilon(), 1.0 / (order + 4)) / problem.fastest;
  const auto missed = [&](double t, const SmoothState& y, double by) {
    return SmoothState((step(y, by) - problem.exact(t + by)) / std::pow(by, order + 1));
  };
  const auto growth = [&](double t, const SmoothState& e) {
    const SmoothState y = problem.exact(t);
    SmoothState d = 2 * missed(t, y, h) - missed(t, y, 2 * h);  // cancels the next order
    const double size = e.norm();
    if (size == 0) return d;
    const double small = 1e-5 * std::max(y.norm(), 1e-3) / size;
    return SmoothState(d + (problem.rate(y + small * e) - problem.rate(y - small * e)) / (2 * small));
  };
  SmoothState e = SmoothState::Zero(problem.exact(0).size());
  const int steps = 100 + static_cast<int>(20 * problem.fastest * time);
  const double dt = time / steps;
  for (int k = 0; k < steps; ++k) {
    const double t = k * dt;
    const SmoothState k1 = growth(t, e), k2 = growth(t + dt / 2, e + dt / 2 * k1),
                      k3 = growth(t + dt / 2, e + dt / 2 * k2), k4 = growth(t + dt, e + dt * k3);
    e += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return e;
}

OneStep euler_step(const Rate& acceleration) {
  return [=](const SmoothState& y, double h) {
    const auto n = y.size() / 2;
    const SmoothState x = y.head(n), v = y.tail(n) + h * acceleration(x);
    return joined_state(x + h * v, v);
  };
}

OneStep verlet_step(const Rate& acceleration) {
  return [=](const SmoothState& y, double h) {
    const auto n = y.size() / 2;
    const SmoothState x = y.head(n), half = y.tail(n) + h / 2 * acceleration(x), next = x + h * half;
    return joined_state(next, half + h / 2 * acceleration(next));
  };
}

OneStep rk4_step(const Rate& rate) {
  return [=](const SmoothState& y, double h) {
    const SmoothState k1 = rate(y), k2 = rate(y + h / 2 * k1), k3 = rate(y + h / 2 * k2),
                      k4 = rate(y + h * k3);
    return SmoothState(y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4));
  };
}

Rate second_order_rate(const Rate& acceleration) {
  return [=](const SmoothState& y) {
    const auto n = y.size() / 2;
    return joined_state(y.tail(n), acceleration(y.head(n)));
  };
}

}  // namespace collidoscope
