#pragma once
// Percentiles of samples: the format of all benchmark results. Plain data.

#include <vector>

namespace collidoscope {

/// Median, 5th and 95th percentile, in the samples' unit. All 0 without samples.
struct Percentiles {
  double median = 0, p5 = 0, p95 = 0;
};

Percentiles percentiles_of(const std::vector<float>& samples);

}  // namespace collidoscope
