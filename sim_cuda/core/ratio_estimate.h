#pragma once
// Compares two things that were measured in turns. Each pair of adjacent measurements gives a ratio, so slow
// drifts of the machine cancel. Free functions over plain data.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace collidoscope {

struct RatioEstimate {
  double ratio = 1;  ///< median
  /// Confidence interval of the median. Without enough pairs: 0 and infinity.
  double low = 0, high = std::numeric_limits<double>::infinity();
  std::int64_t pairs = 0;
  /// Whether the interval excludes equality.
  bool differs() const { return low > 1 || high < 1; }
};

/// The interval is between two order statistics, by the binomial distribution, and so assumes nothing about
/// the distribution of the ratios (Conover, "Practical Nonparametric Statistics", section 3.2). It needs 6
/// pairs for a confidence of 0.95.
RatioEstimate estimate_ratio(std::vector<double> ratios, double confidence = 0.95);

/// Such as "3.1 % ± 0.6 faster than auto, 41 pairs". The ratio is a time over that of `other`.
std::string verdict(const RatioEstimate& estimate, const std::string& other);

}  // namespace collidoscope
