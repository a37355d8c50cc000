#pragma once
// Rotation updates of the kind `lie_group`: torque-free rotation of a rigid body. Splitting method: a
// sequence of rotations about the principal axes, each the exact flow of that axis' part of the kinetic
// energy (Dullweber, Leimkuhler, McLachlan 1997; Touma, Wisdom 1994):
//
//   x(h/2) y(h/2) z(h) y(h/2) x(h/2)     second order, with semi_implicit_euler and velocity_verlet
//   five of those, over 0.41 h, 0.41 h, -0.66 h, 0.41 h, 0.41 h (Suzuki 1990)     fourth order, with rk4
//
// Orientations stay rotations, and the world angular momentum is conserved to rounding. The energy error
// oscillates without drift, because the method is a time-reversible Poisson map: the exact motion of a nearby
// body. RKMK4 (Munthe-Kaas 1999) needs four evaluations instead of 25 rotations. But its energy drifts, and
// at the same h tumbling bodies have 20 times the error, fast tops 1.2 times.
//
// Each rotation is a Cayley map of fourth order in the angle (cayley.h). Slender bodies use slender_body.h.
// Pure functions of SI units.

#include "sim_cuda/dynamics/cayley.h"
#include "sim_cuda/dynamics/slender_body.h"

namespace collidoscope {

/// Fractions of h of the composed substeps. Symmetric; their sum is 1.
struct SecondOrderRotation {
  static constexpr int parts = 1;
  static constexpr double share(int) { return 1; }
};
struct FourthOrderRotation {
  static constexpr int parts = 5;
  static constexpr double outer = 0.41449077179437573714;  ///< 1 / (4 - 4^(1/3))
  static constexpr double share(int part) { return part == 2 ? 1 - 4 * outer : outer; }
};

/// Updates q (principal axes to world) and w (rad/s, world axes) over h s. Returns whether w changed.
template <class Parts, class Real>
SIM_HD bool rotate_lie_group(Quaternion<Real>& q, Vector3<Real>& w, const Vector3<Real>& inertia, Real h) {
  if (inertia.x() == inertia.y() && inertia.y() == inertia.z()) {
    q = cayley_rotation<Real>((h / 2) * w) * q;
    normalise(q);
    return false;
  }
  if (const int axis = slender_axis(inertia); axis >= 0) {
    rotate_slender(axis, q, w, inertia, h);
    return true;
  }
  const Vector3<Real> w_body = q.conjugate() * w;
  Vector3<Real> body(inertia.x() * w_body.x(), inertia.y() * w_body.y(), inertia.z() * w_body.z());
  const Vector3<Real> momentum = q * body;
  for (int part = 0; part < Parts::parts; ++part) {
    const Real quarter = Real(Parts::share(part)) * h / 4;  // a half of the half step of an outer rotation
    const auto rotate = [&](int k, Real half_time) {
      rotate_about_axis(k, half_time * body[k] / inertia[k], q, body);
    };
    rotate(0, quarter);
    rotate(1, quarter);
    rotate(2, 2 * quarter);
    rotate(1, quarter);
    rotate(0, quarter);
  }
  normalise_evenly(q);
  body = q.conjugate() * momentum;
  w = q * Vector3<Real>(body.x() / inertia.x(), body.y() / inertia.y(), body.z() / inertia.z());
  return true;
}

}  // namespace collidoscope
