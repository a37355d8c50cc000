#pragma once
// Position update: the paper's FORWARDDYNAMICS (section 3.1) by semi-implicit Euler. Updates velocity, then
// position with the new velocity, then orientation.

#include <optional>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/dynamics/continuous_collision.h"
#include "sim_cuda/dynamics/slender_body.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// One step of torque-free rotation. The angular momentum L = R I R^T w is conserved. The body rotates by the
/// Cayley map q' = normalised (1, h w / 2) q, second order in the angle: by 2 atan(h|w|/2) about w. w'
/// follows from L in the new axes. First order in h overall. For a sphere the axis is exact and w is
/// constant. Slender bodies use slender_body.h. Returns whether w changed.
template <class Real>
SIM_HD bool rotate_first_order(Quaternion<Real>& q, Vector3<Real>& w, const Vector3<Real>& inertia, Real h) {
  const Vector3<Real> half = (h / 2) * w;
  const Quaternion<Real> rotation(Real(1), half.x(), half.y(), half.z());
  if (inertia.x() == inertia.y() && inertia.y() == inertia.z()) {
    q = rotation * q;
    normalise(q);
    return false;
  }
  if (const int axis = slender_axis(inertia); axis >= 0) {
    rotate_slender(axis, q, w, inertia, h);
    return true;
  }
  const Vector3<Real> w_body = q.conjugate() * w;
  const Vector3<Real> momentum =
      q * Vector3<Real>(inertia.x() * w_body.x(), inertia.y() * w_body.y(), inertia.z() * w_body.z());
  q = rotation * q;
  normalise_evenly(q);
  const Vector3<Real> l_body = q.conjugate() * momentum;
  w = q * Vector3<Real>(l_body.x() / inertia.x(), l_body.y() / inertia.y(), l_body.z() / inertia.z());
  return true;
}

template <class Real>
struct MoveBodies {
  BodyView<Real> bodies;
  Vector3<Real> acceleration;  ///< m/s^2
  Vector3<Real> low, high;     ///< m, the container
  Real h;                      ///< s
  ClampedMotion<Real> motion;  ///< no limit without continuous collision
  bool with_acceleration;      ///< add the acceleration to the velocity
  bool with_container;         ///< the container has walls
  bool with_rotation;          ///< integrate rotation in this stage
  const StepControl* control;

  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    Vector3<Real> v = bodies.velocity[body];
    if (with_acceleration) {
      v += h * acceleration;
      bodies.velocity[body] = v;
    }
    const Vector3<Real> x = bodies.position[body];
    Vector3<Real> next;
    if (motion.limit != nullptr)
      next = x + motion.clamped_displacement(body, x, v, h);
    else
      next = x + h * v;
    if (with_container) {
      // The walls have already stopped bodies that would leave. This clamps the rounding error of a sphere
      // smaller than that error.
      for (int k = 0; k < 3; ++k)
        if (x[k] >= low[k] && x[k] <= high[k] && finite(next[k]))
          next[k] = clamp_to(next[k], low[k], high[k]);
    }
    bodies.position[body] = next;
    if (with_rotation) {
      Vector3<Real> w = bodies.angular_velocity[body];
      if (rotate_first_order<Real>(bodies.orientation[body], w, bodies.inertia[body], h))
        bodies.angular_velocity[body] = w;
    }
  }
};

/// Enqueues the stage "move" with the active effects. `gravity` in m/s^2, `h` in s. `box`: empty without
/// walls. `motion`: used with continuous_collision, and then gravity is not added here.
template <class Real>
void move_bodies(Executor& executor, const BodyView<Real>& bodies, std::int64_t body_count, Effects effects,
                 const Vector3<Real>& gravity, const std::optional<Box>& box, Real h,
                 const StepControl* control, const std::uint8_t* asleep = nullptr,
                 const ClampedMotion<Real>& motion = {});

}  // namespace collidoscope
