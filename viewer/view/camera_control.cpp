#include "viewer/view/camera_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace collidoscope {
namespace {

constexpr double right_angle = 0.5 * std::numbers::pi;

// Metres per pixel at the distance of the target.
double metres_per_pixel(const OrbitCamera& camera, double height) {
  return 2 * std::tan(0.5 * camera.field_of_view) * camera.distance / std::max(height, 1.0);
}

}  // namespace

void orbit(OrbitCamera& camera, double dx, double dy, double height) {
  const double turn = std::numbers::pi / std::max(height, 1.0);
  camera.azimuth = std::remainder(camera.azimuth - dx * turn, 2 * std::numbers::pi);
  camera.elevation = std::clamp(camera.elevation + dy * turn, -right_angle, right_angle);
}

void pan(OrbitCamera& camera, double dx, double dy, double height) {
  const double scale = metres_per_pixel(camera, height);
  const Matrix3d axes = camera.axes();
  camera.target += scale * (-dx * axes.col(0) + dy * axes.col(1));
}

void zoom(OrbitCamera& camera, double steps, double x, double y, double width, double height, double nearest,
          double farthest) {
  const double before = metres_per_pixel(camera, height);
  camera.distance = std::clamp(camera.distance * std::pow(0.88, steps), nearest, farthest);
  const double gained = before - metres_per_pixel(camera, height);
  const Matrix3d axes = camera.axes();
  camera.target += gained * ((x - 0.5 * width) * axes.col(0) - (y - 0.5 * height) * axes.col(1));
}

void fly(OrbitCamera& camera, const Vector3d& metres) {
  const Matrix3d axes = camera.axes();
  camera.target += metres.x() * axes.col(0) + metres.y() * axes.col(1) - metres.z() * axes.col(2);
}

void look(OrbitCamera& camera, double dx, double dy, double height) {
  const Vector3d eye = camera.eye();
  orbit(camera, 0.5 * dx, 0.5 * dy, height);
  camera.target += eye - camera.eye();
}

void look_along(OrbitCamera& camera, AxisView view) {
  camera.elevation = view == AxisView::top ? right_angle : 0;
  camera.azimuth = view == AxisView::side ? 0 : -right_angle;
}

std::vector<std::pair<double, double>> sphere_outline(const OrbitCamera& camera, const Vector3d& center,
                                                      double radius, double width, double height) {
  const Matrix3d axes = camera.axes();
  const Vector3d eye = camera.eye(), to = center - eye;
  const double distance = to.norm();
  Vector3d away = -axes.col(2);
  double reach = radius, nearer = 0;
  if (!camera.orthographic) {
    if (distance <= radius * 1.001) return {};
    away = to / distance;
    // The circle where the cone of view lines touches the sphere.
    nearer = radius * radius / distance;
    reach = radius * std::sqrt(1 - radius * radius / (distance * distance));
  }
  const Vector3d side =
      away.cross(std::abs(away.z()) < 0.9 ? Vector3d(0, 0, 1) : Vector3d(1, 0, 0)).normalized();
  const Vector3d up = side.cross(away);
  const double tangent = std::tan(0.5 * camera.field_of_view);
  std::vector<std::pair<double, double>> points;
  constexpr int corners = 64;
  for (int k = 0; k < corners; ++k) {
    const double turn = 2 * std::numbers::pi * k / corners;
    const Vector3d at = to - nearer * away + reach * (std::cos(turn) * side + std::sin(turn) * up);
    const double depth = -at.dot(axes.col(2));
    if (!camera.orthographic && depth <= 1e-9) return {};
    const double scale = 0.5 * height / (tangent * (camera.orthographic ? camera.distance : depth));
    points.emplace_back(0.5 * width + at.dot(axes.col(0)) * scale,
                        0.5 * height - at.dot(axes.col(1)) * scale);
  }
  return points;
}

}  // namespace collidoscope
