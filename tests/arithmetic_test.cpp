// Tests the portable arithmetic against the C++ standard library, including NaN, infinities and the edges of
// each range. The CPU and the GPU must give the same bits.
#include "sim_cuda/core/arithmetic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace collidoscope {
namespace {

constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();
constexpr float inf_f = std::numeric_limits<float>::infinity();

TEST(Arithmetic, MinAndMaxKeepTheFirstBesideNaN) {
  EXPECT_EQ(min_of(1.0f, nan_f), 1.0f);
  EXPECT_EQ(max_of(1.0f, nan_f), 1.0f);
  EXPECT_TRUE(std::isnan(min_of(nan_f, 1.0f)));
  EXPECT_EQ(min_of(2, 3), 2);
  EXPECT_EQ(max_of(2, 3), 3);
}

TEST(Arithmetic, ClampTakesNaNToTheLowerEnd) {
  EXPECT_EQ(clamp_to(nan_f, -1.0f, 1.0f), -1.0f);
  EXPECT_EQ(clamp_to(inf_f, -1.0f, 1.0f), 1.0f);
  EXPECT_EQ(clamp_to(-inf_f, -1.0f, 1.0f), -1.0f);
  EXPECT_EQ(clamp_to(0.25f, -1.0f, 1.0f), 0.25f);
}

TEST(Arithmetic, CellsAreDefinedForEveryNumber) {
  EXPECT_EQ(to_cell(nan_f, 1024u), 0u);
  EXPECT_EQ(to_cell(-5.0f, 1024u), 0u);
  EXPECT_EQ(to_cell(3.99f, 1024u), 3u);
  EXPECT_EQ(to_cell(1e30f, 1024u), 1023u);
  EXPECT_EQ(to_cell(inf_f, 1u << 21), (1u << 21) - 1);
}

TEST(Arithmetic, NeighboursAreThoseOfNextafter) {
  std::mt19937_64 random(1);
  for (int k = 0; k < 100000; ++k) {
    const auto x = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (!std::isfinite(x)) continue;
    EXPECT_EQ(next_down(x), std::nextafterf(x, -inf_f));
    EXPECT_EQ(next_up(x), std::nextafterf(x, inf_f));
  }
  EXPECT_EQ(next_down(0.0f), -std::numeric_limits<float>::denorm_min());
  EXPECT_EQ(next_up(-0.0f), std::numeric_limits<float>::denorm_min());
  EXPECT_EQ(next_up(inf_f), inf_f);
}

TEST(Arithmetic, RoundingOutwardBracketsEveryDouble) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> spread(-1e6, 1e6);
  for (int k = 0; k < 100000; ++k) {
    const double x = spread(random);
    EXPECT_LE(static_cast<double>(round_down(x)), x);
    EXPECT_GE(static_cast<double>(round_up(x)), x);
    EXPECT_LE(round_up(x), next_up(round_down(x)));  // at most the next float
  }
  EXPECT_EQ(round_down(1e300), std::numeric_limits<float>::infinity());  // never in a box: see BodyBounds
}

TEST(Arithmetic, FiniteIsStdIsfinite) {
  for (const float x : {0.0f, -0.0f, 1e-45f, 3e38f, inf_f, -inf_f, nan_f}) {
    EXPECT_EQ(finite(x), std::isfinite(x));
    EXPECT_EQ(finite(static_cast<double>(x)), std::isfinite(static_cast<double>(x)));
  }
}

}  // namespace
}  // namespace collidoscope
