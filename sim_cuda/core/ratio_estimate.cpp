#include "sim_cuda/core/ratio_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace collidoscope {
namespace {

/// The largest k for which fewer than k of n values lie below the median with at most this probability.
std::size_t lowest_rank(std::size_t n, double probability) {
  double term = std::pow(0.5, static_cast<double>(n)), sum = term;  // of k - 1 values below
  std::size_t k = 0;
  while (sum <= probability && k < n / 2) {
    ++k;
    term *= static_cast<double>(n - k + 1) / static_cast<double>(k);
    sum += term;
  }
  return k;
}

}  // namespace

RatioEstimate estimate_ratio(std::vector<double> ratios, double confidence) {
  RatioEstimate estimate;
  estimate.pairs = std::ssize(ratios);
  if (ratios.empty()) return estimate;
  std::ranges::sort(ratios);
  const std::size_t n = ratios.size();
  estimate.ratio = n % 2 == 1 ? ratios[n / 2] : (ratios[n / 2 - 1] + ratios[n / 2]) / 2;
  const std::size_t rank = lowest_rank(n, (1 - confidence) / 2);
  if (rank == 0) return estimate;
  estimate.low = ratios[rank - 1];
  estimate.high = ratios[n - rank];
  return estimate;
}

std::string verdict(const RatioEstimate& estimate, const std::string& other) {
  const std::string pairs = fmt::format("{} pair{}", estimate.pairs, estimate.pairs == 1 ? "" : "s");
  if (!std::isfinite(estimate.high)) return fmt::format("too few pairs to compare with {}, {}", other, pairs);
  const double half = 50 * (estimate.high - estimate.low);
  if (!estimate.differs())
    return fmt::format("no difference from {} within {:.1f} %, {}", other,
                       100 * std::max(1 - estimate.low, estimate.high - 1), pairs);
  return fmt::format("{:.1f} % ± {:.1f} {} than {}, {}", 100 * std::abs(1 - estimate.ratio), half,
                     estimate.ratio < 1 ? "faster" : "slower", other, pairs);
}

}  // namespace collidoscope
