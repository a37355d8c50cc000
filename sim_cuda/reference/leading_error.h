#pragma once
// Theoretical leading error of a one-step method, computed without running the method to the end.
// For y' = f(y) and a method of order p with the local error h^(p+1) d(y), the error at time t is h^p E(t) +
// O(h^(p+1)), where
//
//   E' = f'(y) E + d(y),  E(0) = 0,  along the exact solution
//
// (Hairer, Norsett, Wanner 1993, II.8). Single steps from the exact solution give d, and a finite difference
// gives f' E. E is therefore accurate to about one percent, and no part of it is fitted to a run.
// Also contains textbook versions of the integrators.

#include <Eigen/Core>
#include <functional>

namespace collidoscope {

using SmoothState = Eigen::VectorXd;
using Rate = std::function<SmoothState(const SmoothState&)>;
using OneStep = std::function<SmoothState(const SmoothState&, double h)>;

struct SmoothProblem {
  Rate rate;                                 ///< f
  std::function<SmoothState(double)> exact;  ///< y(t), t in s
  double fastest;                            ///< 1/s, > 0: fastest relative rate of change of y
};

/// E(time), in the units of y over s^order.
SmoothState leading_error(const SmoothProblem& problem, const OneStep& step, int order, double time);

/// Semi-implicit Euler for y = (x, v), x'' = a(x): kick, then drift with the new velocity. Order 1.
OneStep euler_step(const Rate& acceleration);
/// Velocity Verlet: half kick, drift, half kick. Order 2.
OneStep verlet_step(const Rate& acceleration);
/// The classical Runge-Kutta method. Order 4.
OneStep rk4_step(const Rate& rate);
/// The rate f of (x, v) for x'' = a(x).
Rate second_order_rate(const Rate& acceleration);

}  // namespace collidoscope
