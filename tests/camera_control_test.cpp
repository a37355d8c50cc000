// Tests the camera's mouse operations against geometry: zoom, pan, orbit, axis views and the outline of a
// sphere.

#include "viewer/view/camera_control.h"

#include <gtest/gtest.h>

#include <cmath>

namespace collidoscope {
namespace {

OrbitCamera example() {
  OrbitCamera camera;
  camera.target = {10, 20, 30};
  camera.distance = 50;
  return camera;
}

// The pixel of a point in a view of 800 x 600.
Eigen::Vector2d seen(const OrbitCamera& camera, const Vector3d& point) {
  const Eigen::Vector4d clip =
      camera.projection(800.0 / 600, 0.1, 1000) * camera.view() * point.homogeneous();
  return {400 + 400 * clip.x() / clip.w(), 300 - 300 * clip.y() / clip.w()};
}

// The point below a pixel, at the distance of the target.
Vector3d under(const OrbitCamera& camera, double x, double y) {
  const double scale = 2 * std::tan(0.5 * camera.field_of_view) * camera.distance / 600;
  const Matrix3d axes = camera.axes();
  return camera.target + scale * ((x - 400) * axes.col(0) - (y - 300) * axes.col(1));
}

TEST(CameraControl, ZoomKeepsWhatIsUnderThePointer) {
  for (const bool orthographic : {false, true}) {
    OrbitCamera camera = example();
    camera.orthographic = orthographic;
    const Vector3d point = under(camera, 600, 100);
    EXPECT_NEAR((seen(camera, point) - Eigen::Vector2d(600, 100)).norm(), 0, 1e-6);
    zoom(camera, 3, 600, 100, 800, 600, 1, 1000);
    EXPECT_LT(camera.distance, 50);
    EXPECT_NEAR((seen(camera, point) - Eigen::Vector2d(600, 100)).norm(), 0, 1e-6);
    zoom(camera, 1000, 600, 100, 800, 600, 1, 1000);
    EXPECT_EQ(camera.distance, 1);
  }
}

TEST(CameraControl, PanKeepsWhatIsUnderThePointer) {
  OrbitCamera camera = example();
  const Vector3d point = under(camera, 300, 200);
  pan(camera, 45, -70, 600);
  EXPECT_NEAR((seen(camera, point) - Eigen::Vector2d(345, 130)).norm(), 0, 1e-6);
}

TEST(CameraControl, OrbitKeepsTheTargetAndLookTheEye) {
  OrbitCamera camera = example();
  orbit(camera, 100, 40, 600);
  EXPECT_EQ(camera.target, Vector3d(10, 20, 30));
  EXPECT_NEAR((camera.eye() - camera.target).norm(), 50, 1e-9);
  orbit(camera, 0, 1e6, 600);
  EXPECT_LE(camera.elevation, 1.571);
  camera = example();
  const Vector3d eye = camera.eye();
  look(camera, 80, -30, 600);
  EXPECT_NEAR((camera.eye() - eye).norm(), 0, 1e-9);
}

TEST(CameraControl, AxisViewsLookAlongAxes) {
  OrbitCamera camera = example();
  look_along(camera, AxisView::front);
  EXPECT_NEAR((camera.axes().col(2) - Vector3d(0, -1, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((camera.axes().col(0) - Vector3d(1, 0, 0)).norm(), 0, 1e-9);
  look_along(camera, AxisView::side);
  EXPECT_NEAR((camera.axes().col(2) - Vector3d(1, 0, 0)).norm(), 0, 1e-9);
  look_along(camera, AxisView::top);
  EXPECT_NEAR((camera.axes().col(2) - Vector3d(0, 0, 1)).norm(), 0, 1e-9);
  EXPECT_NEAR((camera.axes().col(0) - Vector3d(1, 0, 0)).norm(), 0, 1e-9);
}

TEST(CameraControl, TheOutlineTouchesTheSphere) {
  for (const bool orthographic : {false, true}) {
    OrbitCamera camera = example();
    camera.orthographic = orthographic;
    const Vector3d center(14, 9, 33);
    const double radius = 6;
    const auto points = sphere_outline(camera, center, radius, 800, 600);
    ASSERT_EQ(points.size(), 64u);
    for (const auto& [x, y] : points) {
      // The ray through each pixel of the outline passes the centre at a distance of one radius.
      const Vector3d through = under(camera, x, y);
      const Vector3d direction =
          orthographic ? Vector3d(-camera.axes().col(2)) : Vector3d((through - camera.eye()).normalized());
      EXPECT_NEAR((center - through).cross(direction).norm(), radius, 1e-6);
    }
  }
  OrbitCamera inside = example();
  EXPECT_TRUE(sphere_outline(inside, inside.eye(), 1, 800, 600).empty());
}

}  // namespace
}  // namespace collidoscope
