#pragma once
// Collision of two spheres: touch tests, contact normal and gap. Pure functions; lengths in m.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/packed_vector.h"

namespace collidoscope {

/// Closed: spheres that share one point touch. Compares squared distances, to avoid the rounding of a square
/// root.
template <class Real>
SIM_HD bool spheres_touch(const Vector3<Real>& a, Real radius_a, const Vector3<Real>& b, Real radius_b) {
  const Vector3<Real> d = b - a;
  const Real reach = radius_a + radius_b;
  return d.dot(d) <= reach * reach;
}

/// Motion of a body in the predicted time, in addition to the acceleration by gravity and attractors.
enum class MotionBound {
  none,              ///< no prediction
  linear,            ///< constant velocity
  linear_with_drag,  ///< constant direction, any loss of speed by drag
  any_direction,     ///< any direction at the current speed; for continuous collision
};

/// Gap of bodies that nearly touch, over the sum of their radii.
inline constexpr double nearly_touching = 1e-3;

/// How far contacts are predicted, in addition to touching pairs.
template <class Real>
struct SpeculativeMargin {
  MotionBound bound = MotionBound::none;
  const PackedVector3<Real>* velocity = nullptr;  ///< m/s, by id
  Real time = 0;                                  ///< s
  Real acceleration_margin = 0;                   ///< m: |acceleration| time^2 of gravity and attractors
  Real rebound = 0;                               ///< largest coefficient of restitution, 0 to 1
};

/// Whether two spheres may touch within the predicted time, as long as each acceleration is gravity minus a
/// frictionless support force.
///
/// Such a support removes the component of g normal to a plane, so each acceleration lies in the ball with
/// diameter g. The relative acceleration is therefore at most |g|, and the gap shrinks by at most time |v_b -
/// v_a| + |g| time^2. (The factor of semi-implicit Euler, K (K + 1) / (2 K^2), is at most 1.) Attractors add
/// at most their largest acceleration to each body. Bodies that nearly touch have a contact even at rest, so
/// that an impact on one of them acts on the others in the same substep.
///
/// An impact may stop one of two bodies that move side by side, or reverse its velocity v. The other one then
/// approaches at up to (1 + e) v. So their relative displacement may also change by s v, where v is the mean
/// of the two velocities and |s| <= (1 + e) time. A body at rest that an impact sets in motion may still meet
/// bodies that are no contacts.
///
/// Drag scales each velocity by any factor l in [0, 1]; the maximum of |l_b v_b - l_a v_a| is at a corner.
/// With MotionBound::any_direction, the bodies may move directly towards each other.
template <class Real>
SIM_HD bool spheres_will_touch(const Vector3<Real>& a, Real radius_a, const Vector3<Real>& velocity_a,
                               const Vector3<Real>& b, Real radius_b, const Vector3<Real>& velocity_b,
                               const SpeculativeMargin<Real>& margin) {
  using std::sqrt;
  const Real near = Real(nearly_touching) * (radius_a + radius_b);
  if (margin.bound == MotionBound::any_direction) {
    const Real speeds = sqrt(velocity_a.dot(velocity_a)) + sqrt(velocity_b.dot(velocity_b));
    return spheres_touch<Real>(a, radius_a, b,
                               radius_b + (margin.time * speeds + 2 * margin.acceleration_margin + near));
  }
  const Vector3<Real> relative_velocity = velocity_b - velocity_a;
  Real squared = relative_velocity.dot(relative_velocity);
  if (margin.bound == MotionBound::linear_with_drag)
    squared = max_of(squared, max_of(velocity_a.dot(velocity_a), velocity_b.dot(velocity_b)));
  const Real distance = margin.time * sqrt(squared) + margin.acceleration_margin + near;
  const Vector3<Real> d = b - a, way = (margin.time * (1 + margin.rebound) / 2) * (velocity_a + velocity_b);
  const Real along = d.dot(way), length = way.dot(way);
  const Real share = length > 0 ? min_of(max_of(along / length, Real(-1)), Real(1)) : Real(0);
  return spheres_touch<Real>(a, radius_a, Vector3<Real>(b - share * way), radius_b + distance);
}

/// Unit normal from a to b, and the gap along it (m; negative if they overlap). The normal is +z for
/// coincident centres, and for centres so close that the squared distance underflows.
template <class Real>
struct Separation {
  Vector3<Real> normal;
  Real gap;
};

template <class Real>
SIM_HD Separation<Real> separate(const Vector3<Real>& a, Real radius_a, const Vector3<Real>& b,
                                 Real radius_b) {
  const Vector3<Real> d = b - a;
  using std::sqrt;
  const Real distance = sqrt(d.dot(d));
  if (!(distance > 0)) return {Vector3<Real>(0, 0, 1), -(radius_a + radius_b)};
  return {d / distance, distance - (radius_a + radius_b)};
}

}  // namespace collidoscope
