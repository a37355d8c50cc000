#pragma once
// Kinematic and static bodies, which no force moves: kinematic ones go on at the velocity and spin that the
// scene gives them, static ones stay. Called for by a body whose `motion` is not "dynamic".
//
// For solvers they are bodies of inverse mass and inverse inertia 0: they push and rub others, and nothing
// comes back; two of them have no contact. Contacts with them are coloured like all others. Stages over all
// bodies need not know of them: what gravity, walls or the box did to one is put back before anybody reads
// it. In sums they have no mass: energies, momenta, depths in walls and the count of the escaped leave them
// out.
//
// Owned by a solver; without such bodies it has no memory and launches nothing.

#include <cstdint>
#include <span>
#include <vector>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"

namespace collidoscope {

/// The kinematic and static bodies.
struct KinematicView {
  const std::uint32_t* body = nullptr;  ///< ids, in the executor's memory
  std::int64_t count = 0;
};

/// Notes where they are and how they move.
template <class Real>
struct SaveKinematic {
  const std::uint32_t* body;
  BodyView<Real> bodies;
  Vector3<Real>*position, *velocity;
  SIM_HD void operator()(int k) const {
    position[k] = bodies.position[body[k]];
    velocity[k] = bodies.velocity[body[k]];
  }
};

/// Takes them `time` further, and writes what is noted. What friction gives to an infinite inertia leaves
/// spin as it is, and orientation turns by it as that of others.
template <class Real>
struct RestoreKinematic {
  const std::uint32_t* body;
  BodyView<Real> bodies;
  Vector3<Real>* position;
  const Vector3<Real>* velocity;
  Real time;  ///< s
  const StepControl* control;
  SIM_HD void operator()(int k) const {
    if (control->overflow) return;
    const Vector3<Real> x = position[k] + time * velocity[k];
    position[k] = x;
    bodies.position[body[k]] = x;
    bodies.velocity[body[k]] = velocity[k];
  }
};

template <class Real>
class KinematicMotion {
 public:
  KinematicMotion(Executor& executor, const BodyView<Real>& bodies, const KinematicView& kinematic,
                  const StepControl* control)
      : executor_(executor),
        bodies_(bodies),
        kinematic_(kinematic),
        control_(control),
        position_(executor, "prescribed positions"),
        velocity_(executor, "prescribed velocities") {
    position_.resize_discarding(static_cast<std::size_t>(kinematic.count));
    velocity_.resize_discarding(static_cast<std::size_t>(kinematic.count));
  }

#if !SIM_CUDA || defined(__CUDACC__)
  /// At the start of a run.
  void begin() {
    if (kinematic_.count > 0)
      executor_.run("prescribe", kinematic_.count,
                    SaveKinematic<Real>{kinematic_.body, bodies_, position_.data(), velocity_.data()});
  }
  /// After stages that may have moved them; `time` in s, after those that move all.
  void restore(Real time = 0) {
    if (kinematic_.count > 0)
      executor_.run("prescribe", kinematic_.count,
                    RestoreKinematic<Real>{kinematic_.body, bodies_, position_.data(), velocity_.data(), time,
                                           control_});
  }
#endif

 private:
  Executor& executor_;
  BodyView<Real> bodies_;
  KinematicView kinematic_;
  const StepControl* control_;
  Buffer<Vector3<Real>> position_, velocity_;  ///< m, m/s
};

}  // namespace collidoscope
