#pragma once
// Sphere against sphere: whether they touch, and along which line.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/packed_vector.h"

namespace collidoscope {

/// Closed: spheres that share one point touch. Squared distances, so that no square root decides.
template <class Real>
SIM_HD bool spheres_touch(const Vector3<Real>& a, Real radius_a, const Vector3<Real>& b, Real radius_b) {
  const Vector3<Real> d = b - a;
  const Real reach = radius_a + radius_b;
  return d.dot(d) <= reach * reach;
}

/// What a body may do within the predicted time, beside what gravity and attractors do to it.
enum class MotionBound {
  none,              ///< stay where it is: nothing is predicted
  linear,            ///< go on
  linear_with_drag,  ///< lose any part of its way to a medium
  any_direction,     ///< turn anywhere, at the speed it has: continuous collision
};

/// How far contacts look ahead, beside what touches now.
template <class Real>
struct SpeculativeMargin {
  MotionBound bound = MotionBound::none;
  const PackedVector3<Real>* velocity = nullptr;  ///< m/s, by id
  Real time = 0;                                  ///< s
  Real acceleration_margin = 0;                   ///< m: |acceleration| time^2 of gravity and attractors
};

/// Whether two spheres may touch within the predicted time while they move smoothly: while each is
/// accelerated by no more than gravity less what holds it up. The relative acceleration of two such bodies is
/// at most |g|: frictionless support leaves of g the part within a plane, so each acceleration lies in the
/// ball over the diameter g. So the gap shrinks by at most time |v_b - v_a| + |g| time^2 (semi-implicit
/// Euler's own K (K + 1) / (2 K^2) is at most 1). Attractors add at most their largest pull to each of the
/// two. Drag leaves of each body's way any part: of |l_b v_b - l_a v_a|, l between 0 and 1, the largest is
/// at a corner. Of two bodies with MotionBound::any_direction, each may come towards the other.
template <class Real>
SIM_HD bool spheres_will_touch(const Vector3<Real>& a, Real radius_a, const Vector3<Real>& velocity_a,
                               const Vector3<Real>& b, Real radius_b, const Vector3<Real>& velocity_b,
                               const SpeculativeMargin<Real>& margin) {
  using std::sqrt;
  if (margin.bound == MotionBound::any_direction) {
    const Real speeds = sqrt(velocity_a.dot(velocity_a)) + sqrt(velocity_b.dot(velocity_b));
    return spheres_touch<Real>(a, radius_a, b,
                               radius_b + (margin.time * speeds + 2 * margin.acceleration_margin));
  }
  const Vector3<Real> relative_velocity = velocity_b - velocity_a;
  Real squared = relative_velocity.dot(relative_velocity);
  if (margin.bound == MotionBound::linear_with_drag)
    squared = max_of(squared, max_of(velocity_a.dot(velocity_a), velocity_b.dot(velocity_b)));
  const Real distance = margin.time * sqrt(squared) + margin.acceleration_margin;
  return spheres_touch<Real>(a, radius_a, b, radius_b + distance);
}

/// The unit normal from a to b, and the gap along it (m; negative where they overlap). Coincident centres, or
/// centres so close that the squared distance underflows, are pushed apart along +z.
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
