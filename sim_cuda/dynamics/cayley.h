#pragma once
// Turns as Cayley maps: a turn by an angle is the quaternion (1, t u), normalised, u being its axis; it turns
// by 2 atan t. With t = half the angle that is of second order in the angle, as the paper's update has it;
// with half_tangent, of fourth. No libm. Pure functions of SI units.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// The tangent of half an angle, to fourth order in the half; beyond a radian, in which it would not matter
/// any more, in proportion.
template <class Real>
SIM_HD Real half_tangent(Real half) {
  return half * (1 + min_of(half * half, Real(1)) / 3);
}

/// By twice `half`, rad, about it, in the world's axes; not normalised.
template <class Real>
SIM_HD Quaternion<Real> cayley_rotation(const Vector3<Real>& half) {
  const Vector3<Real> tangent = (1 + min_of(half.dot(half), Real(1)) / 3) * half;
  return {Real(1), tangent.x(), tangent.y(), tangent.z()};
}

/// A body turns about its own principal axis `k` by twice `half`. `momentum`: in its axes, which turn.
template <class Real>
SIM_HD void rotate_about_axis(int k, Real half, Quaternion<Real>& q, Vector3<Real>& momentum) {
  using std::sqrt;
  const Real t = half_tangent(half), c = 1 / sqrt(1 + t * t), s = c * t;
  Quaternion<Real> rotation(c, 0, 0, 0);
  rotation.coeffs()[k] = s;  // Eigen's order is x y z w
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

/// The same without bias, for what carries an angular momentum from turn to turn. The root of the float next
/// above 1 is 1, so that normalise() leaves |q|^2 above 1 by 5e-8 on average, and each turn by such a q makes
/// vectors longer: an angular momentum by 8 % in 4e5 turns. With Newton's last step it is less than 1 %.
template <class Real>
SIM_HD void normalise_evenly(Quaternion<Real>& q) {
  normalise(q);
  q.coeffs() += (1 - q.coeffs().dot(q.coeffs())) / 2 * q.coeffs();
}

}  // namespace collidoscope
