// The ball that is thrown from the eye: where it starts, and when there is none.

#include "viewer/live/thrown_ball.h"

#include <gtest/gtest.h>

namespace collidoscope {
namespace {

TEST(ThrownBall, StartsAtTheEyeOrWhereItFitsBetweenTheWalls) {
  const Vector3d along(1, 0, 0);
  const std::optional<Body> open = thrown_ball({-200, 3, 4}, 5 * along, 150, {});
  ASSERT_TRUE(open.has_value());
  EXPECT_EQ(open->position, Vector3d(-200, 3, 4));
  EXPECT_EQ(open->radius, 3);
  EXPECT_EQ(open->velocity, Vector3d(50, 0, 0));

  const Box walls;  // 100 m
  EXPECT_EQ(thrown_ball({-200, 50, 50}, along, 150, walls)->position, Vector3d(3, 50, 50));
  EXPECT_EQ(thrown_ball({40, 50, 50}, along, 150, walls)->position, Vector3d(40, 50, 50));
  EXPECT_FALSE(thrown_ball({-200, 98, 50}, along, 150, walls)) << "past the walls";
  EXPECT_FALSE(thrown_ball({200, 50, 50}, along, 150, walls)) << "away from them";
  EXPECT_FALSE(thrown_ball({-200, 50, 50}, along, 3000, walls)) << "too large";

  const std::optional<Body> slanted = thrown_ball({-40, -20, 160}, Vector3d(1, 1, -1), 150, walls);
  ASSERT_TRUE(slanted.has_value());
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GE(slanted->position[axis], 3 - 1e-9);
    EXPECT_LE(slanted->position[axis], 97 + 1e-9);
  }
}

}  // namespace
}  // namespace collidoscope
