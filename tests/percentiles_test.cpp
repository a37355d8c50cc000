// Tests percentiles against sorted samples, one sample and no sample.
#include "headless/reporting/percentiles.h"

#include <gtest/gtest.h>

namespace collidoscope {
namespace {

TEST(Percentiles, OfNumbersInAnyOrder) {
  std::vector<float> samples;
  for (int i = 0; i <= 100; ++i) samples.push_back(static_cast<float>((37 * i) % 101));
  const Percentiles spread = percentiles_of(samples);
  EXPECT_DOUBLE_EQ(spread.median, 50);
  EXPECT_DOUBLE_EQ(spread.p5, 5);
  EXPECT_DOUBLE_EQ(spread.p95, 95);
}

TEST(Percentiles, OfOneAndOfNothing) {
  EXPECT_EQ(percentiles_of({3}).p5, 3);
  EXPECT_EQ(percentiles_of({3}).p95, 3);
  EXPECT_EQ(percentiles_of({}).median, 0);
}

}  // namespace
}  // namespace collidoscope
