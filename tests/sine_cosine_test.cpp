// Tests sine and cosine against the C library: ordinary angles, angles next to multiples of pi/2, and angles
// that are too large to be reduced.
#include "sim_cuda/core/sine_cosine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/random.h"

namespace collidoscope {
namespace {

/// Error in units in the last place of `exact`.
double units(double value, long double exact) {
  const double near = std::abs(static_cast<double>(exact));
  return static_cast<double>(std::abs(value - exact)) / (std::nextafter(near, 2.0) - near);
}

double error_at(double x) {
  const auto [sine, cosine] = sine_and_cosine(x);
  const auto exact = static_cast<long double>(x);
  return std::max(units(sine, std::sin(exact)), units(cosine, std::cos(exact)));
}

TEST(SineCosine, AreRightToAUnitInTheLastPlace) {
  Uniform uniform{Random(1)};
  for (const double range : {1e-3, 1.0, 100.0, 1e5, 1.6e6})
    for (int k = 0; k < 50000; ++k) {
      const double x = uniform(-range, range);
      ASSERT_LT(error_at(x), 1.1) << x;
    }
}

TEST(SineCosine, AreRightNextToMultiplesOfAQuarterTurn) {
  const double quarter = std::acos(0.0);
  for (int n = -100000; n <= 100000; ++n)
    for (const double x :
         {n * quarter, std::nextafter(n * quarter, 1e9), std::nextafter(n * quarter, -1e9)}) {
      ASSERT_LT(error_at(x), 1.1) << x;
    }
}

TEST(SineCosine, OfLargeAnglesAreOffByTheRoundingOfTheAngle) {
  Uniform uniform{Random(2)};
  for (const double range : {1e7, 1e9, 1e12, 1e15})
    for (int k = 0; k < 10000; ++k) {
      const double x = uniform(-range, range);
      const auto [sine, cosine] = sine_and_cosine(x);
      ASSERT_NEAR(sine, std::sin(x), 0x1p-53 * range) << x;
      ASSERT_NEAR(cosine, std::cos(x), 0x1p-53 * range) << x;
      ASSERT_NEAR(sine * sine + cosine * cosine, 1, 1e-12) << x;
    }
}

TEST(SineCosine, OfAnglesBeyondAnyMeaning) {
  for (const double x : {0x1p50, -1e300}) {
    EXPECT_EQ(sine_and_cosine(x).sine, 0);
    EXPECT_EQ(sine_and_cosine(x).cosine, 1);
  }
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double x : {infinity, -infinity, std::nan("")}) {
    EXPECT_TRUE(std::isnan(sine_and_cosine(x).sine));
    EXPECT_TRUE(std::isnan(sine_and_cosine(x).cosine));
  }
  EXPECT_EQ(sine_and_cosine(5e-324).sine, 5e-324);
}

}  // namespace
}  // namespace collidoscope
