#include "viewer/live/thrown_ball.h"

#include <algorithm>
#include <limits>

#include "sim_cuda/scene/limits.h"

namespace collidoscope {

std::optional<Body> thrown_ball(const Vector3d& eye, const Vector3d& direction, double size,
                                const std::optional<Box>& walls) {
  Body ball;
  ball.radius = std::clamp(size / 50, limits::min_radius, limits::max_radius);
  ball.velocity = direction.normalized() * (size / 3);
  double from = 0, to = std::numeric_limits<double>::infinity();  // m along the way
  for (int axis = 0; axis < 3 && walls; ++axis) {
    const double low = walls->min[axis] + ball.radius, high = walls->max[axis] - ball.radius;
    const double speed = ball.velocity[axis] / (size / 3);
    if (!(low < high) || (speed == 0 && (eye[axis] < low || eye[axis] > high))) return std::nullopt;
    if (speed == 0) continue;
    const double a = (low - eye[axis]) / speed, b = (high - eye[axis]) / speed;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  if (from > to) return std::nullopt;
  ball.position = eye + from * direction.normalized();
  return ball;
}

}  // namespace collidoscope
