#pragma once
// Time of the next contact of two objects in free flight: the relevant root of their overlap function.
//
// Rounding leaves bodies slightly overlapping, so the next root alone would miss collisions or report them
// twice. The rule of Bannerman, Strobl, Formella, Poeschel 2014 (Comp. Part. Mech. 1, 191; arXiv 1211.6718)
// avoids this. A collision is the first time from now on at which the objects overlap or touch *and*
// approach.
// Objects that overlap and approach collide now. Objects that overlap and separate collide only after they
// approach again.
// Roots are computed without cancellation, from + - * / and square roots only. Stateless functions.

#include <cmath>
#include <limits>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

inline constexpr double never = std::numeric_limits<double>::infinity();

/// Time in s until two spheres touch. Their centres are `d` m apart and move at the relative velocity `v`
/// m/s. Uniform gravity cancels, because it accelerates both alike.
/// For touching spheres, approach speeds up to `noise` m/s count as rounding.
inline double time_to_contact(const Vector3d& d, const Vector3d& v, double reach, double noise) {
  const double closing = d.dot(v);  // m^2/s, half the rate of |d|^2
  if (!(closing < 0)) return never;
  const double apart = d.dot(d) - reach * reach;
  if (apart <= 0) return -closing > noise * reach ? 0 : never;
  // closing^2 - v^2 apart without cancellation: v^2 (reach^2 - (miss distance)^2).
  const double root = reach * reach * v.dot(v) - d.cross(v).squaredNorm();
  if (!(root >= 0)) return never;
  return apart / (std::sqrt(root) - closing);
}

/// Time in s until gap + speed t + pull t^2 / 2 (m, m/s, m/s^2) reaches 0 from above, or turns back below 0.
/// Applies to a sphere and a plane in uniform gravity, and to a centre and a cell edge. `noise` as above.
inline double time_to_plane(double gap, double speed, double pull, double noise) {
  const double root = speed * speed - 2 * pull * gap;
  if (gap <= 0) {
    if (speed < -noise) return 0;
    if (!(pull < 0)) return never;
    if (speed <= 0) return 0;
    return root > 0 ? (speed + std::sqrt(root)) / -pull : speed / -pull;
  }
  if (!(root >= 0)) return never;
  if (speed < 0) return 2 * gap / (std::sqrt(root) - speed);
  return pull < 0 ? (speed + std::sqrt(root)) / -pull : never;
}

}  // namespace collidoscope
