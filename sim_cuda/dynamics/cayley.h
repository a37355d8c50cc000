#pragma once
// Rotation by the Cayley map: the quaternion (1, h w / 2), normalised, rotates by 2 atan(h |w| / 2) about w.
// It is second order in the angle. Also normalisation of quaternions. Pure functions of SI units.

#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

template <class Real>
SIM_HD bool is_isotropic(const Vector3<Real>& inertia) {
  return inertia.x() == inertia.y() && inertia.y() == inertia.z();
}

/// The Cayley map of the rotation vector h w, not normalised.
template <class Real>
SIM_HD Quaternion<Real> cayley_rotation(const Vector3<Real>& w, Real h) {
  const Vector3<Real> half = (h / 2) * w;
  return {Real(1), half.x(), half.y(), half.z()};
}

template <class Real>
SIM_HD void normalise(Quaternion<Real>& q) {
  using std::sqrt;
  q.coeffs() /= sqrt(q.coeffs().dot(q.coeffs()));
}

/// Normalises without bias, for rotations that transport an angular momentum over many steps. Reason: the
/// square root of the next float above 1 is 1, so normalise() leaves |q|^2 too large by 5e-8 on average. Each
/// rotation by such a q lengthens vectors: an angular momentum grows by 8 % in 4e5 rotations. With a final
/// Newton step it is less than 1 %.
template <class Real>
SIM_HD void normalise_evenly(Quaternion<Real>& q) {
  normalise(q);
  q.coeffs() += (1 - q.coeffs().dot(q.coeffs())) / 2 * q.coeffs();
}

/// Rotates a body with three equal moments of inertia for h s, under every rotation update. w (rad/s, world
/// axes) is constant, and the axis of the rotation is exact.
template <class Real>
SIM_HD void rotate_isotropic(Quaternion<Real>& q, const Vector3<Real>& w, Real h) {
  q = cayley_rotation(w, h) * q;
  normalise(q);
}

}  // namespace collidoscope
