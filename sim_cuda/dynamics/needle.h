#pragma once
// Needles: bodies with two equal moments of inertia, many times the third. Left to itself such a body turns
// about its own axis, and that about its angular momentum, both at constant rates (Landau, Lifshitz,
// Mechanics, 33 and 35), so both turns can be made as they are, whatever h. An update that only keeps the
// angular momentum L may not: it puts an error of the order of (h w)^2 L along the needle, whose moment there
// makes a large spin of it; from h w = root(I/I_across) on that error grows from step to step, up to
// I_across/I times the energy.
//
// Of bodies whose two large moments differ, that is left: they need so small an h. Pure functions of SI
// units.

#include "sim_cuda/dynamics/cayley.h"

namespace collidoscope {

/// The principal axis of a needle; -1: it is none. Below the factor every h that follows a turn at all is
/// small enough for the other updates.
template <class Real>
SIM_HD int needle_axis(const Vector3<Real>& inertia) {
  constexpr int slender = 16;
  for (int k = 0; k < 3; ++k) {
    const Real across = inertia[(k + 1) % 3];
    if (across == inertia[(k + 2) % 3] && across > slender * inertia[k]) return k;
  }
  return -1;
}

/// q, from principal axes to the world's, and w, rad/s in the world's, of the needle along `axis` after h s.
/// w goes round L with the needle, not by way of L, of which its spin along the needle is a rounding error.
template <class Real>
SIM_HD void turn_needle(int axis, Quaternion<Real>& q, Vector3<Real>& w, const Vector3<Real>& inertia,
                        Real h) {
  const Vector3<Real> w_body = q.conjugate() * w;
  const Vector3<Real> momentum =
      q * Vector3<Real>(inertia.x() * w_body.x(), inertia.y() * w_body.y(), inertia.z() * w_body.z());
  const Real across = inertia[(axis + 1) % 3];
  Vector3<Real> own = Vector3<Real>::Zero();
  own[axis] = h / 2 * (w_body[axis] - inertia[axis] * w_body[axis] / across);
  Quaternion<Real> precession = turn_along<Real>(h / 2 / across * momentum);
  normalise_evenly(precession);
  q = precession * q * turn_along<Real>(own);
  normalise_evenly(q);
  w = precession * w;
}

}  // namespace collidoscope
