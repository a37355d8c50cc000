#pragma once
// The observed order of convergence of a method.

#include <cmath>
#include <functional>

namespace collidoscope {

/// The slope of log error over log step, between runs of `first` and 8 x `first` steps.
inline double order_of_error(const std::function<double(int steps)>& error, int first) {
  return std::log2(error(first) / error(8 * first)) / 3;
}

}  // namespace collidoscope
