#pragma once
// Statistics of samples. Pure functions.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace collidoscope {

/// The q-quantile (0 to 1) by linear interpolation between order statistics. Returns `of_none` if there are
/// no samples.
template <class Number>
double quantile(std::vector<Number> samples, double q, double of_none = 0) {
  if (samples.empty()) return of_none;
  std::ranges::sort(samples);
  const double place = q * static_cast<double>(samples.size() - 1);
  const auto low = static_cast<std::size_t>(place);
  const auto below = static_cast<double>(samples[low]);
  const auto above = static_cast<double>(samples[std::min(low + 1, samples.size() - 1)]);
  if (below == above) return below;  // also if both are infinite
  return below + (place - static_cast<double>(low)) * (above - below);
}

}  // namespace collidoscope
