#pragma once
// Kinematic and static bodies, which forces do not move. Kinematic bodies keep the velocity and spin of the
// scene; static bodies do not move. The effect is required if the `motion` of a body is not "dynamic".
//
// Solvers treat them as bodies with inverse mass and inverse inertia 0: they exert contact and friction
// forces without reaction. Two of them have no contact. Their contacts are coloured like all others. Stages
// over all bodies may modify them; their state is restored after every such stage. They have no mass in sums:
// energies, momenta, wall penetrations and the count of escaped bodies exclude them.
//
// Owned by a solver. Without such bodies it allocates no memory and launches nothing.

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

/// Saves their positions and velocities.
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

/// Advances the saved positions by `time` and restores the saved state. Spin needs no restore, because
/// friction does not change it at infinite inertia. Orientation is integrated like that of other bodies.
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
  /// Call at the start of a run.
  void begin() {
    if (kinematic_.count > 0)
      executor_.run("prescribe", kinematic_.count,
                    SaveKinematic<Real>{kinematic_.body, bodies_, position_.data(), velocity_.data()});
  }
  /// Call after stages that may have moved these bodies. `time`, s: the time by which the stage has advanced
  /// all bodies.
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
