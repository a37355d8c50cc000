#pragma once
// The order that a method shows.

#include <cmath>
#include <functional>

namespace collidoscope {

/// The slope of log error over log step, from a run of `first` steps to one of 8 times as many.
inline double order_of_error(const std::function<double(int steps)>& error, int first) {
  return std::log2(error(first) / error(8 * first)) / 3;
}

}  // namespace collidoscope
