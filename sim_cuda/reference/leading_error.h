#pragma once
// What theory says a method's error is, without running the method: on y' = f(y) a method of order p whose
// step errs by h^(p+1) d(y) is off by h^p E(t) + O(h^(p+1)) after t s, where
//
//   E' = f'(y) E + d(y),  E(0) = 0,  along the exact solution
//
// (Hairer, Norsett, Wanner 1993, II.8). d comes of single steps that start on the exact solution, f' E of a
// difference; so E holds to about a percent, and nothing in it was fitted to a run. Beside it, the methods
// as books write them.

#include <Eigen/Core>
#include <functional>

namespace collidoscope {

using SmoothState = Eigen::VectorXd;
using Rate = std::function<SmoothState(const SmoothState&)>;
using OneStep = std::function<SmoothState(const SmoothState&, double h)>;

struct SmoothProblem {
  Rate rate;                                 ///< f
  std::function<SmoothState(double)> exact;  ///< y(t), t in s
  double fastest;                            ///< 1/s, > 0: how fast y can change by about its own size
};

/// E(time), in the units of y over s^order.
SmoothState leading_error(const SmoothProblem& problem, const OneStep& step, int order, double time);

/// Of y = (x, v), x'' = a(x): kick, then drift with the new velocity; order 1.
OneStep euler_step(const Rate& acceleration);
/// Half a kick, drift, half a kick; order 2.
OneStep verlet_step(const Rate& acceleration);
/// The classical Runge-Kutta method; order 4.
OneStep rk4_step(const Rate& rate);
/// f of x'' = a(x).
Rate second_order_rate(const Rate& acceleration);

}  // namespace collidoscope
