// Tests the order in which compared worlds make their steps.

#include "sim_cuda/tuning/steps_in_turns.h"

#include <gtest/gtest.h>

#include <map>

namespace collidoscope {
namespace {

TEST(StepsInTurns, HaveABalancedOrder) {
  for (const std::size_t count : {1u, 2u, 3u, 5u}) {
    std::map<std::pair<std::size_t, std::size_t>, int> positions;
    std::vector<int> after_itself(count);
    std::size_t previous = order_of_turn(count, 2 * count - 1).back();
    for (std::size_t turn = 0; turn < 2 * count; ++turn) {
      const std::vector<std::size_t> order = order_of_turn(count, turn);
      ASSERT_EQ(order.size(), count);
      if (order.front() == previous) ++after_itself[previous];
      previous = order.back();
      for (std::size_t k = 0; k < count; ++k) ++positions[{order[k], k}];
    }
    ASSERT_EQ(positions.size(), count * count);
    for (const auto& [world_and_position, often] : positions) EXPECT_EQ(often, 2);
    for (const int often : after_itself) EXPECT_EQ(often, after_itself[0]) << count;
  }
  EXPECT_EQ(order_of_turn(2, 0), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(order_of_turn(2, 1), (std::vector<std::size_t>{1, 0}));
}

}  // namespace
}  // namespace collidoscope
