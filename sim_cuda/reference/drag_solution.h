#pragma once
// A sphere that a medium slows, without other forces: v' = -a v - b v^2 for its speed. dynamics/drag.h says
// what a and b are; this is the solution.

#include <cmath>

namespace collidoscope {

/// a (1/s) and b (1/m) >= 0, not both 0.
struct DragSolution {
  double linear, quadratic;

  /// m/s at t s, of what starts at `start` m/s.
  double speed(double start, double t) const {
    // (1 - exp(-a t)) / a, which is t for a = 0.
    const double grown = linear > 0 ? -std::expm1(-linear * t) / linear : t;
    return start * std::exp(-linear * t) / (1 + quadratic * start * grown);
  }
  double rate(double speed) const { return -(linear + quadratic * speed) * speed; }  ///< m/s^2
};

}  // namespace collidoscope
