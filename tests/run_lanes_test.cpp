// Tests the ranges of values over a whole run against the values themselves.

#include "sim_cuda/run/run_lanes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

namespace collidoscope {
namespace {

constexpr float unmeasured = std::numeric_limits<float>::quiet_NaN();

float value_of(std::int64_t state) {
  return state % 3 == 0 ? unmeasured : static_cast<float>((state * 7919) % 1000);
}

void expect_ranges(const RunLanes& lanes, std::int64_t last, std::int64_t cut_at) {
  for (std::size_t k = 0; k < lanes.items().size(); ++k) {
    const std::int64_t from = lanes.first() + static_cast<std::int64_t>(k) * lanes.states_per_item();
    const std::int64_t to = std::min(from + lanes.states_per_item() - 1, last);
    if (from <= cut_at && cut_at < to) continue;  // part of the item was forgotten
    float low = unmeasured, high = unmeasured;
    for (std::int64_t state = std::max<std::int64_t>(from, lanes.first() + 1); state <= to; ++state) {
      low = std::fmin(low, value_of(state));
      high = std::fmax(high, value_of(state));
    }
    const RunLanes::Range& range = lanes.items()[k][RunLanes::contacts];
    ASSERT_EQ(std::isnan(range.low), std::isnan(low)) << from;
    if (std::isnan(low)) continue;
    ASSERT_EQ(range.low, low) << from;
    ASSERT_EQ(range.high, high) << from;
  }
}

TEST(RunLanes, HoldTheRangesOfRunsOfAnyLength) {
  for (const std::int64_t steps : {1, 500, 1023, 1024, 1025, 5000, 100'000}) {
    RunLanes lanes;
    lanes.begin(40);
    for (std::int64_t state = 41; state <= 40 + steps; ++state)
      lanes.add(state, {0, value_of(state), unmeasured});
    EXPECT_LE(lanes.items().size(), 1024u);
    EXPECT_GE(static_cast<std::int64_t>(lanes.items().size()) * lanes.states_per_item(), steps);
    expect_ranges(lanes, 40 + steps, -1);
    EXPECT_TRUE(std::isnan(lanes.total(RunLanes::step_ms).high));
    EXPECT_EQ(lanes.total(RunLanes::energy).high, 0);
    if (steps >= 5000) {
      EXPECT_EQ(lanes.total(RunLanes::contacts).high, 999);
    }
  }
}

TEST(RunLanes, ForgetTheStatesAfterABranch) {
  RunLanes lanes;
  lanes.begin(0);
  for (std::int64_t state = 1; state <= 5000; ++state) lanes.add(state, {0, value_of(state), 0});
  lanes.forget_after(2001);
  EXPECT_LE((static_cast<std::int64_t>(lanes.items().size()) - 1) * lanes.states_per_item(), 2001);
  for (std::int64_t state = 2002; state <= 3000; ++state) lanes.add(state, {0, value_of(state), 0});
  expect_ranges(lanes, 3000, 2001);
  lanes.forget_after(-1);
  EXPECT_TRUE(lanes.items().empty());
}

}  // namespace
}  // namespace collidoscope
