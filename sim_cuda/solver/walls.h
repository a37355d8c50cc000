#pragma once
// Spheres against static planes, for the solver `impulse`: the six faces of the box and half-space
// obstacles.
//
// A body that would penetrate a plane at the end of the step bounces now, at most h |v| before it touches.
// If it is too slow to bounce, it gets the speed that keeps it on the plane after gravity. So spheres never
// enter a wall at any speed. Orthogonal planes, such as the box faces, do not undo each other. A body that
// only bounces, faster than 2 g h, then moves freely, from its velocity after the bounce. It is on the
// parabola of an impact at the surface.
//
// The total energy of a body does not rise over a step. A bounce keeps e <= 1 of the speed. A body at gap s
// that would cross the plane ends on it with speed s/h. Then s^2/h^2 / 2 <= v^2 / 2 + g s, since this is
// convex in s and true at both ends.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/solver/restitution.h"

namespace collidoscope {

/// Number of bits in the masks of a body (SoftWalls): the first planes and boxes have one each.
inline constexpr int plane_mask_bits = 32;

/// The half-space normal . x >= offset, in which bodies stay.
template <class Real>
struct WallPlane {
  Vector3<Real> normal;  ///< unit
  Real offset;           ///< m
  Real restitution;      ///< 0 to 1
  Real friction;         ///< 0 to 100
};

/// Resolves the planes of a body in order: obstacles, then box faces. Box faces are last, so no body leaves
/// the box.
template <class Real>
struct ResolveWalls {
  BodyView<Real> bodies;
  const WallPlane<Real>* planes;
  int plane_count;
  Restitution<Real> restitution;
  Vector3<Real> gravity;  ///< m/s^2, zero if the effect is off
  Real h;                 ///< length of a run, s
  StaticImpulse* static_impulses;
  PackedVector3<Real>* start_velocity;  ///< see FreeIntegrator; or null
  const StepControl* control;

  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    Vector3<Real> x = bodies.position[body], v = bodies.velocity[body];
    const Real r = bodies.radius[body], m = bodies.mass[body];
    bool moved = false, hit = false, held = false;
    const auto apply_impulse = [&](const Vector3<Real>& normal, Real change) {
      const Vector3<Real> step = change * normal;
      v += step;
      hit = true;
      StaticImpulse& sum = static_impulses[body];
      sum.impulse += static_cast<double>(m * change);
      for (int k = 0; k < 3; ++k) sum.vector[k] += static_cast<double>(m * step[k]);
    };
    for (int p = 0; p < plane_count; ++p) {
      const WallPlane<Real> plane = planes[p];
      Real gap = plane.normal.dot(x) - plane.offset - r;
      if (gap < 0) {
        // A static plane absorbs any correction, so the whole depth is removed at once.
        const Vector3<Real> shift = -gap * plane.normal;
        x += shift;
        gap = 0;
        moved = true;
        static_impulses[body].push_work -= static_cast<double>(m * gravity.dot(shift));
      }
      const Real speed = plane.normal.dot(v), gain = h * plane.normal.dot(gravity);
      if (!(gap + h * (speed + gain) < 0)) continue;
      const Real e = restitution.between(restitution.of_body(static_cast<std::uint32_t>(body)),
                                         plane.restitution, -speed);
      const bool fast = -speed > -2 * gain;
      const Real bounce = !(speed < 0) ? Real(0)
                          : fast       ? rebound_speed(-speed, gap, -gain / h, e)
                                       : -e * speed;
      const Real stay = -gap / h - gain, target = max_of(bounce, stay);
      if (!(target > speed)) continue;
      apply_impulse(plane.normal, target - speed);
      held = held || !(fast && bounce > stay);
    }
    // A bounce that would cross the whole box in this step ends on the opposite wall.
    for (int p = 0; hit && p < plane_count; ++p) {
      const WallPlane<Real> plane = planes[p];
      const Real gap = max_of(plane.normal.dot(x) - plane.offset - r, Real(0));
      const Real speed = plane.normal.dot(v), stay = -gap / h - h * plane.normal.dot(gravity);
      if (!(stay > speed)) continue;
      apply_impulse(plane.normal, stay - speed);
      held = true;
    }
    if (moved) bodies.position[body] = x;
    if (hit) bodies.velocity[body] = v;
    if (hit && !held && start_velocity != nullptr) start_velocity[body] = v;
  }
};

}  // namespace collidoscope
