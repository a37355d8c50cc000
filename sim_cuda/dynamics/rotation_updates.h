#pragma once
// Rotation updates of bodies with unequal moments of inertia: torque-free rotation over h s. Bodies with
// equal moments use rotate_isotropic() (cayley.h). Pure functions of SI units.
//
// lie_group. The angular momentum L and the kinetic energy E are conserved to rounding, for every inertia and
// every h. All arithmetic is in double.
//
// 1. Splitting. The axes i, j are those with the closest inverse moments. If both had the moment I_i, the
//    body would be a symmetric top about the third axis, s. The rest of the energy is
//    (1/I_j - 1/I_i) L_j^2 / 2. Both parts have exact flows. The top rotates about its own axis s, and with
//    it about L, both at constant rates (Landau, Lifshitz, Mechanics, 33 and 35). The rest is a rotation
//    about axis j. Half of the rest, the top, half of the rest (Strang 1968) is a method of second order
//    (splitting of rigid bodies: Touma, Wisdom 1994; Dullweber, Leimkuhler, McLachlan 1997; about a symmetric
//    top: Fasso 2003). With rk4, five of these over 0.41 h, 0.41 h, -0.66 h, 0.41 h, 0.41 h make the fourth
//    order (Suzuki 1990).
// 2. Projection. The splitting conserves |L|, and the error of E has the order of the method. At the end of
//    the step the body is rotated so that L, constant in world axes, has the energy of the start in body axes
//    (projection onto an invariant: Hairer, Lubich, Wanner 2006, IV.4). Both have closed forms; there is no
//    iteration. L then moves along the exact curve of Euler's equations, and only its place on the curve and
//    the angle about L have an error.
//
// A symmetric top has no rest, and its rotation is exact for every h.
//
// first_order. The paper's update. It conserves L, not E: a body with unequal moments drifts to
// rotation about the axis of least inertia, and gains energy up to L^2 / 2 I of that axis.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/sine_cosine.h"
#include "sim_cuda/dynamics/cayley.h"

namespace collidoscope {

/// Fractions of h of the composed substeps of lie_group. Symmetric; their sum is 1.
struct RotationParts {
  int count = 1;                                           ///< 1: second order, 5: fourth order
  static constexpr double outer = 0.41449077179437573714;  ///< 1 / (4 - 4^(1/3))
  SIM_HD double share(int part) const { return count == 1 ? 1 : part == 2 ? 1 - 4 * outer : outer; }
};

/// The principal axis of a slender body, whose moment is less than 1/16 of each of the others; else -1.
template <class Real>
SIM_HD int slender_axis(const Vector3<Real>& inertia) {
  constexpr int ratio = 16;
  for (int k = 0; k < 3; ++k)
    if (inertia[(k + 1) % 3] > ratio * inertia[k] && inertia[(k + 2) % 3] > ratio * inertia[k]) return k;
  return -1;
}

namespace detail {

/// A cyclic exchange of the axes that makes axis `s` the third.
SIM_HD inline Vector3d with_axis_last(const Vector3d& v, int s) {
  if (s == 0) return {v.y(), v.z(), v.x()};
  if (s == 1) return {v.z(), v.x(), v.y()};
  return v;
}
SIM_HD inline Vector3d with_axis_restored(const Vector3d& v, int s) {
  if (s == 0) return {v.z(), v.x(), v.y()};
  if (s == 1) return {v.y(), v.z(), v.x()};
  return v;
}

/// The axis whose other two axes have the closest inverse moments.
SIM_HD inline int axis_of_top(const Vector3d& inverse) {
  const auto distance = [](double a, double b) { return a < b ? b - a : a - b; };
  const double x = distance(inverse.y(), inverse.z()), y = distance(inverse.z(), inverse.x()),
               z = distance(inverse.x(), inverse.y());
  return z <= x && z <= y ? 2 : y <= x ? 1 : 0;
}

/// Rotates the body about its second axis by 2 `half` rad: appends the rotation to `turn`, and transforms
/// `l`, a vector that is constant in world axes, to the new body axes.
SIM_HD inline void rotate_about_second(double half, Quaterniond& turn, Vector3d& l) {
  const auto [s, c] = sine_and_cosine(half);
  turn = turn * Quaterniond(c, 0, s, 0);
  const double cosine = c * c - s * s, sine = 2 * s * c, x = l.x(), z = l.z();
  l.x() = cosine * x - sine * z;
  l.z() = cosine * z + sine * x;
}
/// The same about the third axis.
SIM_HD inline void rotate_about_third(double half, Quaterniond& turn, Vector3d& l) {
  const auto [s, c] = sine_and_cosine(half);
  turn = turn * Quaterniond(c, 0, 0, s);
  const double cosine = c * c - s * s, sine = 2 * s * c, x = l.x(), y = l.y();
  l.x() = cosine * x + sine * y;
  l.y() = cosine * y - sine * x;
}

SIM_HD inline double weighted_square(const Vector3d& weight, const Vector3d& l) {
  return weight.x() * (l.x() * l.x()) + weight.y() * (l.y() * l.y()) + weight.z() * (l.z() * l.z());
}

/// The unit vector nearest to `l` on a great circle through it where sum(b_k l_k^2) is `wanted`.
/// Precondition: `wanted` is not outside [min b, max b], except for rounding.
///
/// First choice: the circle along the gradient. With the unit tangent t, sum(b_k l_k^2) at the angle phi is
/// A cos^2 + B sin^2 + 2 C sin cos, so u = tan phi solves (B - wanted) u^2 + 2 C u + (A - wanted) = 0. If no
/// point of that circle has the value, or the gradient is 0, the circle through the axis of the largest or
/// smallest b, along which the sum is monotone.
SIM_HD inline Vector3d with_energy(const Vector3d& l, const Vector3d& b, double wanted) {
  using std::sqrt;
  const double a = weighted_square(b, l);
  if (a == wanted) return l;
  const Vector3d gradient(b.x() * l.x() - a * l.x(), b.y() * l.y() - a * l.y(), b.z() * l.z() - a * l.z());
  const double c = sqrt(gradient.dot(gradient));
  if (c > 0) {
    const Vector3d t = gradient / c;
    const double squared = c * c - (weighted_square(b, t) - wanted) * (a - wanted);
    if (squared >= 0) {
      const Vector3d moved = l + (wanted - a) / (c + sqrt(squared)) * t;
      return moved / sqrt(moved.dot(moved));
    }
  }
  int k = 0;  // the axis to approach
  for (int other = 1; other < 3; ++other)
    if (wanted > a ? b[other] > b[k] : b[other] < b[k]) k = other;
  Vector3d across = l;
  across[k] = 0;
  const double length = sqrt(across.dot(across));
  if (!(length > 0)) return l;
  across /= length;
  const double sine_squared = clamp_to((b[k] - wanted) / (b[k] - weighted_square(b, across)), 0.0, 1.0);
  Vector3d moved = sqrt(sine_squared) * across;
  moved[k] = l[k] < 0 ? -sqrt(1 - sine_squared) : sqrt(1 - sine_squared);
  return moved;
}

/// A rotation of the body about L x gradient, after which the direction of L in body axes is `next`, and its
/// direction in world axes is the same as before.
SIM_HD inline Quaterniond rotation_between(const Vector3d& l, const Vector3d& next) {
  const Vector3d axis = next.cross(l);
  Quaterniond q(1 + l.dot(next), axis.x(), axis.y(), axis.z());
  normalise(q);
  return q;
}

}  // namespace detail

/// Updates q (principal axes to world) and w (rad/s, world axes; see wide_spin.h). `Parts`: RotationParts;
/// tests pass wrong fractions. Returns whether w changed.
template <class Real, class Parts>
SIM_HD bool rotate_lie_group(Quaternion<Real>& q, Vector3d& w, const Vector3<Real>& inertia, Real h,
                             const Parts& parts) {
  using std::sqrt;
  Quaterniond axes = q.template cast<double>();
  normalise_evenly(axes);
  const Vector3d moments = inertia.template cast<double>();
  const Vector3d inverse(1 / moments.x(), 1 / moments.y(), 1 / moments.z());
  const int s = detail::axis_of_top(inverse);
  const Vector3d w_body = axes.conjugate() * w;
  Vector3d l = detail::with_axis_last(
      Vector3d(moments.x() * w_body.x(), moments.y() * w_body.y(), moments.z() * w_body.z()), s);
  const double momentum = sqrt(l.dot(l));
  if (momentum == 0) return false;
  l /= momentum;
  const Vector3d a = detail::with_axis_last(inverse, s);

  // The axis nearest to L. Relative to its energy, that of L has no cancellation if L is close to the axis.
  // Rounding would else be a perturbation of a rotation about the middle axis, which it amplifies.
  const Vector3d size(l.x() * l.x(), l.y() * l.y(), l.z() * l.z());
  const double nearest = size.x() >= size.y() && size.x() >= size.z() ? a.x()
                         : size.y() >= size.z()                       ? a.y()
                                                                      : a.z();
  const Vector3d b(a.x() - nearest, a.y() - nearest, a.z() - nearest);
  const double energy = detail::weighted_square(b, l);

  const double rest = a.y() - a.x(), own = a.z() - a.x(), angle = momentum * static_cast<double>(h);
  Quaterniond turn(1, 0, 0, 0);  // of the body, in body axes of the start
  for (int part = 0; part < parts.count; ++part) {
    const double half = parts.share(part) * angle / 2;
    if (rest != 0) detail::rotate_about_second(half / 2 * rest * l.y(), turn, l);
    const auto [sine, cosine] = sine_and_cosine(half * a.x());
    turn = turn * Quaterniond(cosine, sine * l.x(), sine * l.y(), sine * l.z());
    detail::rotate_about_third(half * own * l.z(), turn, l);
    if (rest != 0) detail::rotate_about_second(half / 2 * rest * l.y(), turn, l);
  }
  l /= sqrt(l.dot(l));
  if (rest != 0) {
    const Vector3d next = detail::with_energy(l, b, energy);
    turn = turn * detail::rotation_between(l, next);
    l = next;
  }

  const Vector3d axis = detail::with_axis_restored(turn.vec(), s);
  axes = axes * Quaterniond(turn.w(), axis.x(), axis.y(), axis.z());
  normalise_evenly(axes);
  q = axes.template cast<Real>();
  // w follows from the stored q, and the next step reads both in the same way. So the rounding of q changes
  // neither |L| nor E.
  axes = q.template cast<double>();
  normalise_evenly(axes);
  l += (1 - l.dot(l)) / 2 * l;  // as normalise_evenly()
  const Vector3d spin = detail::with_axis_restored(
      Vector3d(momentum * (a.x() * l.x()), momentum * (a.y() * l.y()), momentum * (a.z() * l.z())), s);
  w = axes * spin;
  return true;
}

/// The paper's update. The angular momentum L = R I R^T w is conserved. The body rotates by the Cayley map of
/// h w, and w' follows from L in the new axes. First order in h. Returns whether w changed.
///
/// Slender bodies use lie_group. Reason: the error of L along the slender axis is of order (h w)^2 L, and the
/// small moment there turns it into a large spin. From h w = sqrt(I / I across) on, it grows from step to
/// step.
template <class Real>
SIM_HD bool rotate_first_order(Quaternion<Real>& q, Vector3d& w, const Vector3<Real>& inertia, Real h) {
  if (slender_axis(inertia) >= 0) return rotate_lie_group(q, w, inertia, h, RotationParts{});
  const Vector3<Real> start = w.cast<Real>(), w_body = q.conjugate() * start;
  const Vector3<Real> momentum =
      q * Vector3<Real>(inertia.x() * w_body.x(), inertia.y() * w_body.y(), inertia.z() * w_body.z());
  q = cayley_rotation(start, h) * q;
  normalise_evenly(q);
  const Vector3<Real> l_body = q.conjugate() * momentum;
  const Vector3<Real> end =
      q * Vector3<Real>(l_body.x() / inertia.x(), l_body.y() / inertia.y(), l_body.z() / inertia.z());
  w = end.template cast<double>();
  return true;
}

}  // namespace collidoscope
