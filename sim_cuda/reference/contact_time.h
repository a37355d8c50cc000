#pragma once
// When two things that fly freely touch next, from now on: the root of their overlap function that counts.
//
// Rounding leaves bodies a little inside of each other, so "the next root" alone would lose collisions or see
// them twice. The rule of Bannerman, Strobl, Formella, Poeschel 2014 (Comp. Part. Mech. 1, 191; arXiv
// 1211.6718): a collision is the first moment, from now on, at which they overlap or touch *and* approach.
// What overlaps and approaches collides now; what overlaps and parts does not, until it approaches again.
// Roots take the form that subtracts nothing of the same sign. + - * / and square roots alone; free
// functions.

#include <cmath>
#include <limits>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

inline constexpr double never = std::numeric_limits<double>::infinity();

/// s until two spheres touch whose centres are `d` m apart and move by `v` m/s against each other, straight:
/// in uniform gravity, which acts on both alike, too. Of two that touch, approaches up to `noise` m/s are
/// rounding.
inline double time_to_contact(const Vector3d& d, const Vector3d& v, double reach, double noise) {
  const double closing = d.dot(v);  // m^2/s, half the rate of |d|^2
  if (!(closing < 0)) return never;
  const double apart = d.dot(d) - reach * reach;
  if (apart <= 0) return -closing > noise * reach ? 0 : never;
  // closing^2 - v^2 apart, without the difference of two large numbers: v^2 (reach^2 - (miss distance)^2).
  const double root = reach * reach * v.dot(v) - d.cross(v).squaredNorm();
  if (!(root >= 0)) return never;
  return apart / (std::sqrt(root) - closing);
}

/// s until gap + speed t + pull t^2 / 2 touches 0 from above (m, m/s, m/s^2), or turns back while it is
/// below: a sphere and a plane in uniform gravity, a centre and the edge of its cell. `noise` as above.
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
