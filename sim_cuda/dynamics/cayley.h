#pragma once
// Rotations by Cayley maps. The quaternion (1, t u), normalised, rotates about the unit axis u by 2 atan t.
// With t = half the angle the map is second order in the angle, as in the paper's update. With half_tangent()
// it is fourth order. No libm. Pure functions of SI units.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// The tangent of half an angle, to fourth order in the half angle. Linear for half angles beyond 1 rad,
/// where accuracy is irrelevant.
template <class Real>
SIM_HD Real half_tangent(Real half) {
  return half * (1 + min_of(half * half, Real(1)) / 3);
}

/// Rotation by the rotation vector 2 `half`, rad, in world axes. Not normalised.
template <class Real>
SIM_HD Quaternion<Real> cayley_rotation(const Vector3<Real>& half) {
  const Vector3<Real> tangent = (1 + min_of(half.dot(half), Real(1)) / 3) * half;
  return {Real(1), tangent.x(), tangent.y(), tangent.z()};
}

/// Rotates a body about its principal axis `k` by 2 `half`, rad. `momentum` is the angular momentum in body
/// axes, which rotate.
template <class Real>
SIM_HD void rotate_about_axis(int k, Real half, Quaternion<Real>& q, Vector3<Real>& momentum) {
  using std::sqrt;
  const Real t = half_tangent(half), c = 1 / sqrt(1 + t * t), s = c * t;
  Quaternion<Real> rotation(c, 0, 0, 0);
  rotation.coeffs()[k] = s;  // Eigen stores x y z w
  q = q * rotation;
  const Real cosine = c * c - s * s, sine = 2 * s * c;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const Real m_i = momentum[i], m_j = momentum[j];
  momentum[i] = cosine * m_i + sine * m_j;
  momentum[j] = cosine * m_j - sine * m_i;
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

}  // namespace collidoscope
