// Tests the comparison of two things that were measured in pairs.

#include "sim_cuda/core/ratio_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace collidoscope {
namespace {

TEST(RatioEstimate, IsTheMedianBetweenOrderStatistics) {
  std::vector<double> ratios;
  for (int k = 20; k >= 1; --k) ratios.push_back(k);
  const RatioEstimate estimate = estimate_ratio(ratios);
  EXPECT_EQ(estimate.ratio, 10.5);
  // Tables of the sign test: for 20 values, the 6th and the 15th have 95.9 %.
  EXPECT_EQ(estimate.low, 6);
  EXPECT_EQ(estimate.high, 15);
  EXPECT_EQ(estimate.pairs, 20);
  EXPECT_EQ(estimate_ratio({3, 1, 2}).ratio, 2);
  // 5 values have 93.75 % between the first and the last; 6 values 96.9 %.
  EXPECT_FALSE(std::isfinite(estimate_ratio({1, 2, 3, 4, 5}).high));
  EXPECT_EQ(estimate_ratio({1, 2, 3, 4, 5, 6}).low, 1);
  EXPECT_EQ(estimate_ratio({1, 2, 3, 4, 5, 6}).high, 6);
  EXPECT_EQ(estimate_ratio({}).pairs, 0);
}

/// The interval contains the true median as often as it says, for distributions with long tails, too.
TEST(RatioEstimate, ContainsTheMedianAsOftenAsItSays) {
  std::mt19937 random(1);
  std::cauchy_distribution<double> cauchy(1, 0.1);
  std::exponential_distribution<double> exponential(1);
  for (const int pairs : {7, 12, 41, 200})
    for (const bool skewed : {false, true}) {
      int contained = 0;
      constexpr int tries = 4000;
      for (int k = 0; k < tries; ++k) {
        std::vector<double> ratios;
        for (int pair = 0; pair < pairs; ++pair)
          ratios.push_back(skewed ? exponential(random) : cauchy(random));
        const RatioEstimate estimate = estimate_ratio(ratios);
        const double median = skewed ? std::log(2) : 1;
        contained += estimate.low <= median && median <= estimate.high;
      }
      // Four standard deviations of the count below 95 %.
      EXPECT_GT(contained, tries * 0.95 - 4 * std::sqrt(tries * 0.95 * 0.05)) << pairs << " pairs";
      EXPECT_LT(contained, tries * 0.99) << pairs << " pairs: much too wide";
    }
}

TEST(RatioEstimate, GivesAVerdict) {
  const auto near = [](double middle, int pairs) {
    std::vector<double> ratios;
    for (int k = 0; k < pairs; ++k) ratios.push_back(middle + 0.001 * (k - pairs / 2));
    return verdict(estimate_ratio(ratios), "auto");
  };
  EXPECT_EQ(near(0.969, 41), "3.1 % ± 0.7 faster than auto, 41 pairs");
  EXPECT_EQ(near(1.2, 41), "20.0 % ± 0.7 slower than auto, 41 pairs");
  EXPECT_EQ(near(1, 41), "no difference from auto within 0.7 %, 41 pairs");
  EXPECT_EQ(near(0.5, 3), "too few pairs to compare with auto, 3 pairs");
  EXPECT_EQ(near(0.5, 1), "too few pairs to compare with auto, 1 pair");
}

}  // namespace
}  // namespace collidoscope
