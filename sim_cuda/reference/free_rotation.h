#pragma once
// Torque-free rotation of a rigid body in closed form (Landau & Lifshitz, Mechanics, 36-37). Principal
// moments in kg m^2, angular velocities in rad/s along principal axes, t in s. Pure functions.

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Orientation of a symmetric top with I = (I1, I1, I3). At t = 0 its axes are the world's axes and its
/// angular velocity is `spin`.
/// It turns about its own axis by (1 - I3/I1) w3 t, and with that axis about L by |L|/I1 t.
Quaterniond symmetric_top(const Vector3d& inertia, const Vector3d& spin, double t);

/// Angular velocity along principal axes for I1 < I2 < I3 and `spin` = (w1, 0, w3), w1, w3 > 0, where L^2 > 2
/// E I2.
/// Equals w = (w1 cn, b sn, w3 dn) of u t. The body turns about axis 3 permanently; it tumbles more as L^2
/// approaches 2 E I2.
Vector3d middle_axis_spin(const Vector3d& inertia, const Vector3d& spin, double t);

}  // namespace collidoscope
