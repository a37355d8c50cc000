#pragma once
// How a time grows with N: t = fixed + scale * N^exponent, fitted to measured medians.

#include <vector>

namespace collidoscope {

struct Sample {
  double n, time;  ///< both > 0
};

struct Growth {
  double fixed = 0;           ///< >= 0, in the unit of time
  double scale = 0;           ///< >= 0
  double exponent = 0;        ///< 0.05 to 3; 0: too few samples
  double exponent_least = 0;  ///< the fit once more without each sample in turn: its extremes
  double exponent_most = 0;
  double error = 0;  ///< root mean square of (t - fit) / t
  double at(double n) const;
};

/// Least squares of relative residuals; of fewer than four different N, nothing.
Growth fit_growth(const std::vector<Sample>& samples);

}  // namespace collidoscope
