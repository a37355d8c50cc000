// Tests the fit of run times (a fixed part plus a power of N) against samples with known parameters.
#include "headless/bench/growth.h"

#include <gtest/gtest.h>

#include <cmath>

namespace collidoscope {
namespace {

std::vector<Sample> samples_of(double fixed, double scale, double exponent) {
  std::vector<Sample> samples;
  for (const double n : {1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5}) {
    samples.push_back({n, fixed + scale * std::pow(n, exponent)});
  }
  return samples;
}

TEST(Growth, FindsWhatTheSamplesWereMadeOf) {
  for (const double exponent : {0.5, 1.0, 1.37, 2.0})
    for (const double fixed : {0.0, 3.0, 40.0}) {
      const double scale = 50 / std::pow(1e4, exponent);  // equal to 50 at the middle size
      const Growth fit = fit_growth(samples_of(fixed, scale, exponent));
      EXPECT_NEAR(fit.exponent, exponent, 0.002) << fixed;
      EXPECT_NEAR(fit.fixed, fixed, 0.05 + 0.01 * fixed) << exponent;
      EXPECT_NEAR(fit.at(3e4), fixed + scale * std::pow(3e4, exponent), 0.05);
      EXPECT_LT(fit.error, 1e-3);
      EXPECT_LE(fit.exponent_least, fit.exponent);
      EXPECT_GE(fit.exponent_most, fit.exponent);
      EXPECT_NEAR(fit.exponent_least, fit.exponent_most, 0.01);
    }
}

TEST(Growth, SaysHowMuchOneSampleWeighs) {
  std::vector<Sample> samples = samples_of(10, 1e-3, 1);
  samples[3].time *= 1.3;
  const Growth fit = fit_growth(samples);
  EXPECT_GT(fit.error, 0.02);
  EXPECT_GT(fit.exponent_most - fit.exponent_least, 0.02);
}

TEST(Growth, OfFewSizesIsNotGuessed) {
  EXPECT_EQ(fit_growth({}).exponent, 0);
  EXPECT_EQ(fit_growth({{1e3, 4}, {1e4, 40}, {1e5, 400}}).exponent, 0);
  EXPECT_EQ(fit_growth({{1e3, 4}, {1e3, 5}, {1e3, 6}, {1e3, 7}}).exponent, 0);
  EXPECT_GT(fit_growth({{1e3, 4}, {1e4, 40}, {1e5, 400}, {1e6, 4000}}).exponent, 0);
}

}  // namespace
}  // namespace collidoscope
