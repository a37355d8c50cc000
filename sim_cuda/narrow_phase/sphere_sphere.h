#pragma once
// Sphere against sphere: whether they touch, and along which line.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Closed: spheres that share one point touch. Squared distances, so that no square root decides.
template <class Real>
SIM_HD bool spheres_touch(const Vector3<Real>& a, Real radius_a, const Vector3<Real>& b, Real radius_b) {
  const Vector3<Real> d = b - a;
  const Real reach = radius_a + radius_b;
  return d.dot(d) <= reach * reach;
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
