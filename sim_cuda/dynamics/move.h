#pragma once
// Position update: the paper's FORWARDDYNAMICS (section 3.1) by semi-implicit Euler. Updates velocity, then
// position with the new velocity, then the orientation of bodies with equal moments of inertia. Bodies with
// unequal moments rotate in a stage of their own (solver/free_integrator.h), bodies of joint trees in relax
// (solver/joint_tree_solver.h).

#include <optional>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/dynamics/cayley.h"
#include "sim_cuda/dynamics/continuous_collision.h"
#include "sim_cuda/dynamics/tree_member.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

template <class Real>
struct MoveBodies {
  BodyView<Real> bodies;
  Vector3<Real> acceleration;  ///< m/s^2
  Vector3<Real> low, high;     ///< m, the container
  Real h;                      ///< s
  ClampedMotion<Real> motion;  ///< no limit without continuous collision
  bool with_acceleration;      ///< add the acceleration to the velocity
  bool with_container;         ///< the container has walls
  bool with_rotation;          ///< rotate bodies with equal moments of inertia
  const StepControl* control;
  const TreeMember* members = nullptr;  ///< by body; null without joint trees

  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    Vector3<Real> v = bodies.velocity[body];
    if (with_acceleration) {
      v += h * acceleration;
      bodies.velocity[body] = v;
    }
    const Vector3<Real> x = bodies.position[body];
    Vector3<Real> next;
    if (motion.limit != nullptr) {
      const Vector3<Real> way = motion.clamped_displacement(body, x, v, h), lost = h * v - way;
      next = x + way;
      if (motion.static_impulses != nullptr && lost.dot(lost) > 0)
        motion.static_impulses[body].push_work +=
            static_cast<double>(bodies.mass[body] * motion.pull(body, acceleration).dot(lost));
    } else {
      next = x + h * v;
    }
    if (with_container) {
      // The walls have already stopped bodies that would leave. This clamps the rounding error of a sphere
      // smaller than that error.
      for (int k = 0; k < 3; ++k)
        if (x[k] >= low[k] && x[k] <= high[k] && finite(next[k]))
          next[k] = clamp_to(next[k], low[k], high[k]);
    }
    bodies.position[body] = next;
    if (!with_rotation) return;
    if (members != nullptr && members[body] != TreeMember::none) return;
    if (is_isotropic(bodies.inertia[body]))
      rotate_isotropic<Real>(bodies.orientation[body], bodies.angular_velocity[body], h);
  }
};

/// Enqueues the stage "move" with the active effects. `gravity` in m/s^2, `h` in s. `box`: empty without
/// walls. `motion`: used with continuous_collision, and then gravity is not added here. `members`: see
/// MoveBodies.
template <class Real>
void move_bodies(Executor& executor, const BodyView<Real>& bodies, std::int64_t body_count, Effects effects,
                 const Vector3<Real>& gravity, const std::optional<Box>& box, Real h,
                 const StepControl* control, const std::uint8_t* asleep = nullptr,
                 const ClampedMotion<Real>& motion = {}, const TreeMember* members = nullptr);

}  // namespace collidoscope
