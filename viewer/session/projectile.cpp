#include "viewer/session/projectile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "sim_cuda/scene/limits.h"

namespace collidoscope {

std::optional<Body> make_projectile(const Vector3d& eye, const Vector3d& direction, double size,
                                    const ProjectileSpace& room) {
  Body ball;
  ball.radius = std::clamp(size / 50, limits::min_radius, limits::max_radius);
  const Vector3d along = direction.normalized();
  ball.velocity = along * (size / 3);
  double from = 0, to = std::numeric_limits<double>::infinity();  // m along the line of sight
  // Keeps the part of the line with normal . position >= offset + radius.
  const auto stay_above = [&](const Vector3d& normal, double offset) {
    const double speed = normal.dot(along), unavailable_reason = offset + ball.radius - normal.dot(eye);
    if (speed > 0)
      from = std::max(from, unavailable_reason / speed);
    else if (speed < 0)
      to = std::min(to, unavailable_reason / speed);
    else if (unavailable_reason > 0)
      to = -1;
  };
  for (int axis = 0; axis < 3 && room.walls; ++axis) {
    stay_above(Vector3d::Unit(axis), room.walls->min[axis]);
    stay_above(-Vector3d::Unit(axis), -room.walls->max[axis]);
  }
  for (const Plane& plane : room.planes) stay_above(plane.normal, plane.offset);
  // Parts of the line where the ball would overlap a body.
  std::vector<std::pair<double, double>> taken;
  for (std::size_t i = 0; i < room.position.size(); ++i) {
    const Vector3d ahead = room.position[i] - eye;
    const double middle = ahead.dot(along), reach = room.radius[i] + ball.radius;
    const double half = reach * reach - (ahead - middle * along).squaredNorm();
    if (half > 0) taken.emplace_back(middle - std::sqrt(half), middle + std::sqrt(half));
  }
  std::ranges::sort(taken);
  for (const auto& [begin, end] : taken)
    if (begin < from && from < end) from = end;
  if (from > to) return std::nullopt;
  ball.position = eye + from * along;
  return ball;
}

}  // namespace collidoscope
