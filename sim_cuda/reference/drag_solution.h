#pragma once
// Closed-form speed of a sphere slowed only by a medium: v' = -a v - b v^2. dynamics/drag.h defines a and b.

#include <cmath>

namespace collidoscope {

/// Coefficients a (1/s) and b (1/m), both >= 0 and not both 0.
struct DragSolution {
  double linear, quadratic;

  /// Speed in m/s after t s; the initial speed is `start` m/s.
  double speed(double start, double t) const {
    // (1 - exp(-a t)) / a; its limit for a = 0 is t.
    const double grown = linear > 0 ? -std::expm1(-linear * t) / linear : t;
    return start * std::exp(-linear * t) / (1 + quadratic * start * grown);
  }
  double rate(double speed) const { return -(linear + quadratic * speed) * speed; }  ///< m/s^2
};

}  // namespace collidoscope
