// Tests the ball thrown from the camera: its start position, and the cases without free space.

#include "viewer/session/projectile.h"

#include <gtest/gtest.h>

namespace collidoscope {
namespace {

TEST(Projectile, StartsAtTheEyeOrWhereItFitsBetweenTheWalls) {
  const Vector3d along(1, 0, 0);
  const std::optional<Body> open = make_projectile({-200, 3, 4}, 5 * along, 150, {});
  ASSERT_TRUE(open.has_value());
  EXPECT_EQ(open->position, Vector3d(-200, 3, 4));
  EXPECT_EQ(open->radius, 3);
  EXPECT_EQ(open->velocity, Vector3d(50, 0, 0));

  ProjectileSpace room;
  room.walls = Box{};  // 100 m
  EXPECT_EQ(make_projectile({-200, 50, 50}, along, 150, room)->position, Vector3d(3, 50, 50));
  EXPECT_EQ(make_projectile({40, 50, 50}, along, 150, room)->position, Vector3d(40, 50, 50));
  EXPECT_FALSE(make_projectile({-200, 98, 50}, along, 150, room)) << "past the walls";
  EXPECT_FALSE(make_projectile({200, 50, 50}, along, 150, room)) << "away from them";
  EXPECT_FALSE(make_projectile({-200, 50, 50}, along, 3000, room)) << "too large";

  const std::optional<Body> slanted = make_projectile({-40, -20, 160}, Vector3d(1, 1, -1), 150, room);
  ASSERT_TRUE(slanted.has_value());
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GE(slanted->position[axis], 3 - 1e-9);
    EXPECT_LE(slanted->position[axis], 97 + 1e-9);
  }
}

TEST(Projectile, StartsAbovePlanesAndBesideBodies) {
  const std::vector<Plane> planes{{.normal = {0, 0, 1}, .offset = 2}};
  ProjectileSpace room;
  room.planes = planes;
  const Vector3d up(0, 0, 1);
  EXPECT_EQ(make_projectile({0, 0, -10}, up, 150, room)->position, Vector3d(0, 0, 5)) << "out of the ground";
  EXPECT_FALSE(make_projectile({0, 0, -10}, -up, 150, room)) << "into it";
  EXPECT_FALSE(make_projectile({0, 0, -10}, Vector3d(1, 0, 0), 150, room)) << "below it";
  EXPECT_EQ(make_projectile({0, 0, 20}, -up, 150, room)->position, Vector3d(0, 0, 20));

  // Three balls in a row while the run is paused.
  std::vector<Vector3d> position{{100, 0, 20}};
  std::vector<double> radius{1};
  for (int k = 0; k < 3; ++k) {
    room.position = position;
    room.radius = radius;
    const std::optional<Body> ball = make_projectile({0, 0, 20}, Vector3d(1, 0, 0), 150, room);
    ASSERT_TRUE(ball.has_value());
    for (std::size_t i = 0; i < position.size(); ++i)
      EXPECT_GE((ball->position - position[i]).norm(), ball->radius + radius[i] - 1e-9);
    EXPECT_NEAR(ball->position.x(), 6 * k, 1e-9);
    position.push_back(ball->position);
    radius.push_back(ball->radius);
  }
}

}  // namespace
}  // namespace collidoscope
