// Tests the rank correlation against closed forms, with equal values and with constant input.
#include "headless/bench/rank_correlation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace collidoscope {
namespace {

TEST(RankCorrelation, SeesOrderAlone) {
  EXPECT_DOUBLE_EQ(rank_correlation({1, 2, 3, 4}, {1, 10, 100, 1e9}), 1);
  EXPECT_DOUBLE_EQ(rank_correlation({1, 2, 3, 4}, {7, 5, -1, -2}), -1);
  // 1 - 6 sum d^2 / (n (n^2 - 1)), without ties
  EXPECT_DOUBLE_EQ(rank_correlation({1, 2, 3, 4, 5}, {2, 1, 4, 3, 5}), 1 - 6.0 * 4 / (5 * 24));
}

TEST(RankCorrelation, SharesTheRanksOfEqualValues) {
  EXPECT_EQ(ranks_of({5, 1, 5, 9, 5}), (std::vector<double>{3, 1, 3, 5, 3}));
  // Pearson's correlation of 1, 2.5, 2.5, 4 with 1, 2, 3, 4.
  EXPECT_NEAR(rank_correlation({1, 2, 2, 3}, {1, 2, 3, 4}), 4.5 / std::sqrt(4.5 * 5), 1e-12);
}

TEST(RankCorrelation, IsNothingWhereNothingVaries) {
  EXPECT_EQ(rank_correlation({}, {}), 0);
  EXPECT_EQ(rank_correlation({1}, {2}), 0);
  EXPECT_EQ(rank_correlation({1, 1, 1}, {1, 2, 3}), 0);
}

}  // namespace
}  // namespace collidoscope
