// Tests the static part of a frame: bounds, floor, grid, runs of meshes, and the view that fits all bodies.
#include "viewer/render/frame_scene.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/executors.h"
#include "tests/gl_fixture.h"
#include "viewer/view/scene_view.h"

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
  EXPECT_NEAR(scene.bounds.min.z(), -10, 1e-12);  // below the body at x = 10
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

TEST(FrameScene, AnAddedBodyLeavesTheSizeAlone) {
  const double size = frame_scene({}, three_bodies()).size;
  Scene scene;
  scene.extra_bodies.resize(1);
  InitialBodies bodies = three_bodies();
  bodies.position.push_back({1000, 0, 0});
  bodies.radius.push_back(1);
  const FrameScene more = frame_scene(scene, bodies);
  EXPECT_EQ(more.size, size);
  EXPECT_EQ(more.bounds.max.x(), 1001);
}

TEST(FrameScene, TheBoundsFollowTheBodies) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vector3d> position{{0, 0, -50}, {none, 0, 0}};
  const std::vector<double> radius{2, 1};
  const Bounds bounds = scene_bounds({}, {}, position, radius);
  EXPECT_EQ(bounds.min, Vector3d(-2, -2, -52));
  EXPECT_EQ(bounds.max, Vector3d(2, 2, -48));
}

// A ball is thrown from the camera. The camera must not frame thrown balls: it would move back with each
// throw.
TEST(SceneView, AThrownBallLeavesTheCameraAndAllShowsWhereBodiesAre) {
  test_context();
  Scene scene;
  scene.bodies.resize(2);
  scene.bodies[1].position = {5, 0, 0};
  LiveWorld live(scene, on_cpu());
  SceneView view(DisplayPath::automatic, {}, [](const std::string&) {});
  const Workspace workspace;
  const TreeInspector tree;
  PublishedState state;
  const auto draw = [&] {
    PublishRequest request;
    request.layers = workspace.layers;
    publish_state(live, request, nullptr, state);
    view.draw(state, workspace, tree, 320, 240);
    view.finish_drawing();
  };
  draw();
  const OrbitCamera before = view.camera();
  const double size = view.scene_size();
  for (int k = 0; k < 3; ++k) {
    Change thrown;
    thrown.add.resize(1);
    thrown.add[0].position = view.camera().eye() + Vector3d(0, 0, 3 * k);
    live.apply(std::move(thrown));
    draw();
    EXPECT_EQ(view.camera(), before);
    EXPECT_EQ(view.scene_size(), size);
  }
  for (int k = 0; k < 60; ++k) live.step(false);  // the bodies fall by about 20 m
  view.handle_request(CameraRequest::frame_all, live);
  EXPECT_LT(view.camera().target.z(), before.target.z() - 10);
}

}  // namespace
}  // namespace collidoscope
