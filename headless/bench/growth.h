#pragma once
// Model of the growth of time with N, fitted to measured medians: t = fixed + scale * N^exponent.

#include <vector>

namespace collidoscope {

struct Sample {
  double n, time;  ///< both > 0
};

struct Growth {
  double fixed = 0;           ///< >= 0, in the unit of time
  double scale = 0;           ///< >= 0
  double exponent = 0;        ///< 0.05 to 3; 0: too few samples
  double exponent_least = 0;  ///< range of the exponents fitted with one sample left out
  double exponent_most = 0;
  double error = 0;  ///< r.m.s. of (t - fit) / t
  double at(double n) const;
};

/// Least-squares fit of relative residuals. Returns a default Growth for fewer than four different N.
Growth fit_growth(const std::vector<Sample>& samples);

}  // namespace collidoscope
