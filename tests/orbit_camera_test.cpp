// Tests the orbit camera against geometry: axes, depth, framing and the scene's own camera.
#include "viewer/render/orbit_camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace collidoscope {
namespace {

Eigen::Vector4d clip(const OrbitCamera& camera, double aspect, const Vector3d& point) {
  return camera.projection(aspect, 0.1, 1000) * (camera.view() * point.homogeneous());
}

TEST(OrbitCamera, AxesAreRightHandedAndLookAtTheTarget) {
  OrbitCamera camera;
  camera.target = {3, -2, 5};
  for (double elevation : {-1.5, 0.0, 0.7, 1.5707963267948966}) {
    camera.elevation = elevation;
    const Matrix3d axes = camera.axes();
    EXPECT_NEAR(axes.determinant(), 1, 1e-12);
    EXPECT_NEAR((axes.transpose() * axes - Matrix3d::Identity()).norm(), 0, 1e-12);
    const Eigen::Vector4d target = clip(camera, 1.5, camera.target);
    EXPECT_NEAR(target.x() / target.w(), 0, 1e-12);
    EXPECT_NEAR(target.y() / target.w(), 0, 1e-12);
    EXPECT_NEAR((camera.eye() - camera.target).norm(), camera.distance, 1e-12);
  }
}

TEST(OrbitCamera, DepthIsOneAtTheNearPlaneAndFallsWithDistance) {
  OrbitCamera camera;
  for (bool orthographic : {false, true}) {
    camera.orthographic = orthographic;
    const Vector3d ahead = -camera.axes().col(2);
    double before = 1;
    for (double distance : {0.1, 1.0, 10.0, 900.0}) {
      const Eigen::Vector4d at = clip(camera, 1, camera.eye() + distance * ahead);
      const double depth = at.z() / at.w();
      if (distance == 0.1) {
        EXPECT_NEAR(depth, 1, 1e-9);
      } else {
        EXPECT_LT(depth, before);
      }
      EXPECT_GT(depth, 0);
      before = depth;
    }
  }
}

TEST(OrbitCamera, FramingShowsAllAndWastesLittle) {
  for (const Bounds& bounds :
       {Bounds{{0, 0, 0}, {100, 100, 100}}, Bounds{{-1, -1, 0}, {1, 1, 40}}, Bounds{{-5, 0, 2}, {70, 1, 3}}})
    for (double aspect : {0.5, 1.0, 2.4})
      for (bool orthographic : {false, true}) {
        OrbitCamera from;
        from.orthographic = orthographic;
        const OrbitCamera camera = frame_all(bounds, aspect, from);
        double reach = 0;
        for (int i = 0; i < 8; ++i) {
          const Vector3d corner(i & 1 ? bounds.max.x() : bounds.min.x(),
                                i & 2 ? bounds.max.y() : bounds.min.y(),
                                i & 4 ? bounds.max.z() : bounds.min.z());
          const Eigen::Vector4d at = clip(camera, aspect, corner);
          reach = std::max({reach, std::abs(at.x() / at.w()), std::abs(at.y() / at.w())});
        }
        EXPECT_LE(reach, 1.0);
        EXPECT_GE(reach, 0.8) << aspect;
      }
}

TEST(OrbitCamera, TheScenesCameraIsHonoured) {
  Camera request;
  request.position = Vector3d(10, -20, 30);
  request.target = Vector3d(1, 2, 3);
  request.vertical_field_of_view = 55;
  const OrbitCamera camera = scene_camera(request, {}, 1.5);
  EXPECT_NEAR((camera.eye() - *request.position).norm(), 0, 1e-9);
  EXPECT_EQ(camera.target, *request.target);
  EXPECT_NEAR(camera.field_of_view, 55 * std::acos(-1.0) / 180, 1e-12);
  request.up = {0, 1, 0};
  const OrbitCamera turned = scene_camera(request, {}, 1.5);
  EXPECT_NEAR((turned.eye() - *request.position).norm(), 0, 1e-9);
  EXPECT_NEAR(turned.axes().col(0).y(), 0, 1e-12);
}

}  // namespace
}  // namespace collidoscope
