#pragma once
// The free body: torque-free rotation in closed form (Landau & Lifshitz, Mechanics, 36-37). Principal moments
// in kg m^2, angular velocities in rad/s along principal axes, t in s. Pure functions.

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// The orientation of a symmetric top, I = (I1, I1, I3), whose axes are the world's at t = 0 and which turns
/// at `spin` then: about its own axis by (1 - I3/I1) w3 t, and with that about L by |L|/I1 t.
Quaterniond symmetric_top(const Vector3d& inertia, const Vector3d& spin, double t);

/// The angular velocity along principal axes of a body with I1 < I2 < I3 that starts at `spin` = (w1, 0, w3),
/// w1, w3 > 0, where L^2 > 2 E I2 (so that it turns about axis 3 for good, and tumbles the nearer L^2 is to
/// 2 E I2): w = (w1 cn, b sn, w3 dn) of u t.
Vector3d middle_axis_spin(const Vector3d& inertia, const Vector3d& spin, double t);

}  // namespace collidoscope
