#pragma once
// Stages of `soft_step` over the planes of all bodies. Functors.

#include <cstdint>

#include "sim_cuda/core/step_control.h"
#include "sim_cuda/solver/soft_walls.h"

namespace collidoscope {

/// One iteration over the planes of all bodies.
template <class Real, bool with_friction, bool with_box_obstacles, bool unequal_moments>
struct SolveWalls {
  SoftWalls<Real, with_friction, with_box_obstacles> walls;
  WallPass pass;
  const StepControl* control;
  SIM_HD int count() const { return walls.count(); }
  /// False only for bodies away from all planes and boxes.
  SIM_HD bool is_near(int id) const {
    return walls.boxes.view.count > 0 || walls.meets_plane(walls.load_motion(id), false);
  }
  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    typename SoftWalls<Real, with_friction, with_box_obstacles>::Body body = walls.load_motion(id);
    const bool relaxing = pass != WallPass::solve;
    if (!walls.may_touch(body, relaxing)) return;
    walls.load_rest(id, body);
    if (!(body.inverse_mass > 0)) return;
    walls.template solve<unequal_moments>(id, body, pass, walls.gravity);
    if (relaxing) walls.template apply_friction<unequal_moments>(id, body);
    walls.store(id, body);
  }
};

/// Ends a step: deactivates planes without impulse.
template <class Real, bool with_friction, bool with_box_obstacles>
struct EndWalls {
  SoftWalls<Real, with_friction, with_box_obstacles> walls;
  const StepControl* control;
  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    typename SoftWalls<Real, with_friction, with_box_obstacles>::Body body;
    body.active_mask = walls.active_mask[id];
    walls.deactivate_unused(id, body);
  }
};

}  // namespace collidoscope
