#include "viewer/render/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace collidoscope {
namespace {

// Two unit vectors orthogonal to `up`; x and y if `up` is z.
void across(const Vector3d& up, Vector3d& first, Vector3d& second) {
  const Vector3d other = std::abs(up.x()) < 0.9 ? Vector3d(1, 0, 0) : Vector3d(0, 1, 0);
  first = (other - up * up.dot(other)).normalized();
  second = up.cross(first);
}

}  // namespace

Vector3d OrbitCamera::eye() const { return target + distance * axes().col(2); }

Matrix3d OrbitCamera::axes() const {
  const Vector3d vertical = up.normalized();
  Vector3d first, second;
  across(vertical, first, second);
  const Vector3d level = std::cos(azimuth) * first + std::sin(azimuth) * second;
  Matrix3d result;
  result.col(2) = std::cos(elevation) * level + std::sin(elevation) * vertical;
  result.col(0) = vertical.cross(level);  // also valid at the poles
  result.col(1) = result.col(2).cross(result.col(0));
  return result;
}

Eigen::Matrix4d OrbitCamera::view() const {
  const Matrix3d turn = axes();
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  result.topLeftCorner<3, 3>() = turn.transpose();
  result.topRightCorner<3, 1>() = -turn.transpose() * eye();
  return result;
}

Eigen::Matrix4d OrbitCamera::projection(double aspect, double near, double far) const {
  const double tangent = std::tan(0.5 * field_of_view);
  Eigen::Matrix4d result = Eigen::Matrix4d::Zero();
  if (orthographic) {
    result(0, 0) = 1 / (tangent * distance * aspect);
    result(1, 1) = 1 / (tangent * distance);
    result(2, 2) = 1 / (far - near);
    result(2, 3) = far / (far - near);
    result(3, 3) = 1;
  } else {
    result(0, 0) = 1 / (tangent * aspect);
    result(1, 1) = 1 / tangent;
    result(2, 3) = near;
    result(3, 2) = -1;
  }
  return result;
}

OrbitCamera frame_all(const Bounds& bounds, double aspect, OrbitCamera from, double margin) {
  from.target = bounds.center();
  const Matrix3d axes = from.axes();
  const double tan_y = std::tan(0.5 * from.field_of_view) / margin, tan_x = tan_y * aspect;
  const auto corner = [&](int i) {
    return Vector3d((i & 1) ? bounds.max.x() : bounds.min.x(), (i & 2) ? bounds.max.y() : bounds.min.y(),
                    (i & 4) ? bounds.max.z() : bounds.min.z());
  };
  // The corner with the largest required distance determines the distance. Then the target moves to the
  // centre of the projected corners, which allows a smaller distance.
  for (int round = 0; round < 8; ++round) {
    from.distance = 1e-6;
    for (int i = 0; i < 8; ++i) {
      const Vector3d at = axes.transpose() * (corner(i) - from.target);
      const double across_picture = std::max(std::abs(at.x()) / tan_x, std::abs(at.y()) / tan_y);
      from.distance = std::max(from.distance, across_picture + (from.orthographic ? 0 : at.z()));
    }
    Eigen::Vector2d low(1e300, 1e300), high(-1e300, -1e300);
    for (int i = 0; i < 8; ++i) {
      const Vector3d at = axes.transpose() * (corner(i) - from.target);
      const Eigen::Vector2d seen = from.orthographic ? Eigen::Vector2d(at.x(), at.y())
                                                     : Eigen::Vector2d(at.x() / (from.distance - at.z()),
                                                                       at.y() / (from.distance - at.z()));
      low = low.cwiseMin(seen);
      high = high.cwiseMax(seen);
    }
    const Eigen::Vector2d middle = 0.5 * (low + high) * (from.orthographic ? 1 : from.distance);
    from.target += axes.col(0) * middle.x() + axes.col(1) * middle.y();
  }
  return from;
}

OrbitCamera scene_camera(const Camera& request, const Bounds& bounds, double aspect) {
  OrbitCamera camera;
  camera.up = request.up.normalized();
  camera.field_of_view = request.vertical_field_of_view * std::numbers::pi / 180;
  if (!request.position) {
    camera = frame_all(bounds, aspect, camera);
    if (request.target) camera.target = *request.target;
    return camera;
  }
  camera.target = request.target ? *request.target : bounds.center();
  const Vector3d back = *request.position - camera.target;
  camera.distance = std::max(back.norm(), 1e-9);
  Vector3d first, second;
  across(camera.up, first, second);
  camera.elevation = std::asin(std::clamp(back.dot(camera.up) / camera.distance, -1.0, 1.0));
  camera.azimuth = std::atan2(back.dot(second), back.dot(first));
  return camera;
}

}  // namespace collidoscope
