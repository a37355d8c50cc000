#include "viewer/render/frame_scene.h"

#include <gtest/gtest.h>

namespace collidoscope {
namespace {

InitialBodies three_bodies() {
  InitialBodies bodies;
  bodies.position = {{0, 0, 5}, {10, 0, 5}, {0, 20, 5}};
  bodies.radius = {1, 2, 3};
  return bodies;
}

TEST(FrameScene, WithoutABoxTheBodiesSpanIt) {
  const FrameScene scene = frame_scene({}, three_bodies());
  EXPECT_EQ(scene.bounds.min, Vector3d(-3, -2, 2));
  EXPECT_EQ(scene.bounds.max, Vector3d(12, 23, 8));
  EXPECT_EQ(scene.floor, 2);
  EXPECT_EQ(scene.body_size, 2);
  ASSERT_EQ(scene.runs.size(), 1u);
  EXPECT_EQ(scene.runs[0].count, 3);
}

TEST(FrameScene, ALevelObstacleIsTheFloor) {
  Scene with_floor;
  with_floor.obstacles = {{.normal = {0, 0, 1}, .offset = -4}, {.normal = {1, 0, 0}, .offset = -50}};
  const FrameScene scene = frame_scene(with_floor, three_bodies());
  EXPECT_EQ(scene.floor, -4);
  EXPECT_EQ(scene.bounds.min.z(), -4);
}

TEST(FrameScene, TheBoundsReachDownToWhereBodiesLand) {
  Scene slope;
  slope.obstacles = {{.normal = Vector3d(1, 0, 1).normalized(), .offset = 0}};
  const FrameScene scene = frame_scene(slope, three_bodies());
  EXPECT_NEAR(scene.bounds.min.z(), -10, 1e-12);  // under the body at x = 10
  EXPECT_EQ(scene.bounds.max, Vector3d(12, 23, 8));
  ASSERT_EQ(scene.planes.size(), 1u);
  slope.physics.gravity = {0, 0, 0};
  EXPECT_EQ(frame_scene(slope, three_bodies()).bounds.min.z(), 2);
}

TEST(FrameScene, MeshesCutTheBodiesIntoRuns) {
  InitialBodies bodies = three_bodies();
  bodies.mesh = {1, 0, 0};
  const FrameScene scene = frame_scene({}, bodies);
  ASSERT_EQ(scene.runs.size(), 2u);
  EXPECT_EQ(scene.runs[0].mesh, 1u);
  EXPECT_EQ(scene.runs[1].first, 1);
  EXPECT_EQ(scene.runs[1].count, 2);
}

TEST(FrameScene, NoBodiesAndTheGridsSteps) {
  EXPECT_TRUE(frame_scene({}, {}).runs.empty());
  for (const auto& [side, spacing] : {std::pair{100.0, 10.0}, {1.0, 0.1}, {761.0, 100.0}, {20.0, 2.0}}) {
    InitialBodies bodies;
    bodies.box = Box{{0, 0, 0}, {side, side, side}};
    EXPECT_NEAR(frame_scene({}, bodies).grid_spacing, spacing, 1e-12) << side;
  }
}

}  // namespace
}  // namespace collidoscope
