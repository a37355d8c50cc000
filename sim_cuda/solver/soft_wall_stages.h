#pragma once
// The stages of `soft_step` over the planes of all bodies: a sweep, the bounce, and the friction of bounces.
// Functors.

#include <cstdint>

#include "sim_cuda/core/step_control.h"
#include "sim_cuda/solver/soft_walls.h"

namespace collidoscope {

/// One sweep over all bodies' planes. `last`: of those that relax.
template <class Real, bool rubbed, bool boxed>
struct SolveWalls {
  SoftWalls<Real, rubbed, boxed> walls;
  bool relaxing, last;
  const StepControl* control;
  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    typename SoftWalls<Real, rubbed, boxed>::Body body = walls.approach(id);
    if (!walls.meets(body, relaxing)) return;
    walls.load_rest(id, body);
    walls.solve(id, body, relaxing, nullptr);
    if (relaxing) walls.rub_all(id, body, last);
    walls.store(id, body);
  }
};

/// The bounce off every plane that the step has touched; makes the next step start afresh.
template <class Real, bool rubbed, bool boxed>
struct BounceOffWalls {
  SoftWalls<Real, rubbed, boxed> walls;
  const StepControl* control;
  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    if (walls.count() <= walls.bits && walls.at[id] == 0) return;
    typename SoftWalls<Real, rubbed, boxed>::Body body = walls.load(id);
    for (int p = 0; p < walls.count(); ++p) {
      if (!walls.is_at(body, p)) continue;
      const std::int64_t place = walls.place(p, id);
      const Real wanted = walls.bounce[place];
      if (wanted < 0) continue;
      walls.bounce[place] = -1;
      const Vector3<Real> normal = walls.touched(p, id);
      const Real speed = normal.dot(body.v);
      if (!(wanted > 0 && wanted > speed)) continue;
      const Real change = body.mass * (wanted - speed);
      walls.give(id, body, normal, change);
      walls.impulse[place] = 0;  // it leaves
      if constexpr (rubbed) {
        walls.grips.impulse[place] = Vector3<Real>::Zero();
        walls.grips.pressed[place] += change;
      }
    }
    if constexpr (!rubbed) walls.leave(id, body);
    walls.store(id, body);
  }
};

/// What a bounce adds to the friction of the step; after all bounces.
template <class Real, bool boxed>
struct GripWalls {
  SoftWalls<Real, true, boxed> walls;
  const StepControl* control;
  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    if (walls.count() <= walls.bits && walls.at[id] == 0) return;
    typename SoftWalls<Real, true, boxed>::Body body = walls.load(id);
    for (int p = 0; p < walls.count(); ++p) {
      if (!walls.is_at(body, p)) continue;
      const std::int64_t place = walls.place(p, id);
      const Real pressed = walls.grips.pressed[place];
      if (!(pressed > 0)) continue;
      walls.rub_plane(id, body, p, walls.touched(p, id), pressed, walls.grips.total[place]);
      walls.grips.pressed[place] = 0;
      walls.grips.total[place] = Vector3<Real>::Zero();
    }
    walls.leave(id, body);
    walls.store(id, body);
  }
};

}  // namespace collidoscope
