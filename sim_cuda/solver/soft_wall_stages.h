#pragma once
// Stages of `soft_step` over the planes of all bodies: iteration, restitution, and friction after
// restitution. Functors.

#include <cstdint>

#include "sim_cuda/core/step_control.h"
#include "sim_cuda/solver/soft_walls.h"

namespace collidoscope {

/// One iteration over the planes of all bodies. `last`: last iteration of relax.
template <class Real, bool with_friction, bool with_box_obstacles>
struct SolveWalls {
  SoftWalls<Real, with_friction, with_box_obstacles> walls;
  bool relaxing, last;
  const StepControl* control;
  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    typename SoftWalls<Real, with_friction, with_box_obstacles>::Body body = walls.load_motion(id);
    if (!walls.may_touch(body, relaxing)) return;
    walls.load_rest(id, body);
    walls.solve(id, body, relaxing, nullptr);
    if (relaxing) walls.apply_friction(id, body, last);
    walls.store(id, body);
  }
};

/// Restitution at every plane touched in the step. Resets the plane's state for the next step.
template <class Real, bool with_friction, bool with_box_obstacles>
struct BounceOffWalls {
  SoftWalls<Real, with_friction, with_box_obstacles> walls;
  const StepControl* control;
  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    if (walls.count() <= walls.mask_bits && walls.active_mask[id] == 0) return;
    typename SoftWalls<Real, with_friction, with_box_obstacles>::Body body = walls.load(id);
    for (int p = 0; p < walls.count(); ++p) {
      if (!walls.is_active(body, p)) continue;
      const std::int64_t place = walls.index(p, id);
      const Real bounce_speed = walls.bounce[place];
      if (bounce_speed < 0) continue;
      walls.bounce[place] = -1;
      const Vector3<Real> normal = walls.contact_normal(p, id);
      const Real speed = normal.dot(body.v);
      if (!(bounce_speed > 0 && bounce_speed > speed)) continue;
      const Real change = body.mass * (bounce_speed - speed);
      walls.apply_normal_impulse(id, body, normal, change);
      walls.impulse[place] = 0;  // the body separates from the plane
      if constexpr (with_friction) {
        walls.friction.impulse[place] = Vector3<Real>::Zero();
        walls.friction.normal_impulse_sum[place] += change;
      }
    }
    if constexpr (!with_friction) walls.deactivate_unused(id, body);
    walls.store(id, body);
  }
};

/// Friction after restitution. Run after all restitution impulses.
template <class Real, bool with_box_obstacles>
struct WallFrictionAfterBounce {
  SoftWalls<Real, true, with_box_obstacles> walls;
  const StepControl* control;
  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    if (walls.count() <= walls.mask_bits && walls.active_mask[id] == 0) return;
    typename SoftWalls<Real, true, with_box_obstacles>::Body body = walls.load(id);
    for (int p = 0; p < walls.count(); ++p) {
      if (!walls.is_active(body, p)) continue;
      const std::int64_t place = walls.index(p, id);
      const Real normal_impulse = walls.friction.normal_impulse_sum[place];
      if (!(normal_impulse > 0)) continue;
      walls.apply_plane_friction(id, body, p, walls.contact_normal(p, id), normal_impulse,
                                 walls.friction.total[place]);
      walls.friction.normal_impulse_sum[place] = 0;
      walls.friction.total[place] = Vector3<Real>::Zero();
    }
    walls.deactivate_unused(id, body);
    walls.store(id, body);
  }
};

}  // namespace collidoscope
