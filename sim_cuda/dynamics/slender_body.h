#pragma once
// Slender bodies: those with one moment of inertia that is a small part of the other two, which then differ
// by no more than it (no body has a moment above the sum of the others). An update that only keeps the
// angular momentum L puts an error of the order of (h w)^2 L along its axis, whose moment there makes a large
// spin of it; from h w = root(I/I_across) on that error grows from step to step, up to I_across/I times the
// energy.
//
// So the kinetic energy goes in two parts, each followed as it is (Strang 1968; Fasso 2003, of any body): a
// body whose moments across are equal turns about its own axis, and that about L, both at constant rates
// (Landau, Lifshitz, Mechanics, 33 and 35); what is left is a turn about one of the axes across, smaller by
// I/I_across, half before and half after. Exact where both moments are equal; else of second order, and
// bounded in energy for every step that follows the tumbling at all. Pure functions of SI units.

#include "sim_cuda/dynamics/cayley.h"

namespace collidoscope {

/// The principal axis of a slender body; -1: it is none. Below the factor every h that follows a turn at all
/// is small enough for the other updates.
template <class Real>
SIM_HD int slender_axis(const Vector3<Real>& inertia) {
  constexpr int ratio = 16;
  for (int k = 0; k < 3; ++k)
    if (inertia[(k + 1) % 3] > ratio * inertia[k] && inertia[(k + 2) % 3] > ratio * inertia[k]) return k;
  return -1;
}

/// q, from principal axes to the world's, and w, rad/s in the world's, of the slender body along `axis` after
/// h s.
template <class Real>
SIM_HD void rotate_slender(int axis, Quaternion<Real>& q, Vector3<Real>& w, const Vector3<Real>& inertia,
                           Real h) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const Vector3<Real> w_body = q.conjugate() * w;
  // In the body's axes throughout: in the world's, its own share of L would be a rounding error.
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
