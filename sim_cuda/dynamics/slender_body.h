#pragma once
// Rotation update for slender bodies: one moment of inertia, I, is much smaller than the other two. Those
// then differ by at most I, because no moment exceeds the sum of the others.
//
// An update that only conserves the angular momentum L has an error of order (h w)^2 L along the slender
// axis. The small moment there turns it into a large spin. From h w = sqrt(I/I_across) on, the error grows
// from step to step, to I_across/I times the energy.
//
// Therefore the kinetic energy is split into two parts, each with an exact flow (Strang 1968; Fasso 2003, for
// any body). The first is a symmetric top: it spins about its own axis, which precesses about L, both at
// constant rates (Landau, Lifshitz, Mechanics, 33 and 35). The rest is a rotation about one transverse axis,
// smaller by I/I_across, applied half before and half after.
//
// Exact if both transverse moments are equal. Otherwise second order, with bounded energy error for every
// step that resolves the tumbling. Pure functions of SI units.

#include "sim_cuda/dynamics/cayley.h"

namespace collidoscope {

/// The principal axis of a slender body; -1 if the body is not slender. Below this ratio, the other updates
/// are stable at every step that resolves the rotation.
template <class Real>
SIM_HD int slender_axis(const Vector3<Real>& inertia) {
  constexpr int ratio = 16;
  for (int k = 0; k < 3; ++k)
    if (inertia[(k + 1) % 3] > ratio * inertia[k] && inertia[(k + 2) % 3] > ratio * inertia[k]) return k;
  return -1;
}

/// Updates q (principal axes to world) and w (rad/s, world axes) of a body slender along `axis`, over h s.
template <class Real>
SIM_HD void rotate_slender(int axis, Quaternion<Real>& q, Vector3<Real>& w, const Vector3<Real>& inertia,
                           Real h) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const Vector3<Real> w_body = q.conjugate() * w;
  // All in body axes: in world axes, the small component of L along the slender axis would be lost to
  // rounding.
  Vector3<Real> body(inertia.x() * w_body.x(), inertia.y() * w_body.y(), inertia.z() * w_body.z());
  const Real unequal = (inertia[i] - inertia[j]) / inertia[i] / inertia[j];
  rotate_about_axis(j, h / 4 * unequal * body[j], q, body);
  const Vector3<Real> momentum = q * body;
  rotate_about_axis(axis, h / 2 * (body[axis] / inertia[axis] - body[axis] / inertia[i]), q, body);
  q = cayley_rotation<Real>(h / 2 / inertia[i] * momentum) * q;
  rotate_about_axis(j, h / 4 * unequal * body[j], q, body);
  normalise_evenly(q);
  w = q * Vector3<Real>(body.x() / inertia.x(), body.y() / inertia.y(), body.z() / inertia.z());
}

}  // namespace collidoscope
