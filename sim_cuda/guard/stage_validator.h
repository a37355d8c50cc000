#pragma once
// The effect `guards`: after each stage that writes quantities with units, a look at all that it wrote. The
// first value that is not finite, or beyond what the scene's `guards` allow, is kept: first in the order of
// the stages of a step, and among those of one stage of the lowest body. Called for by a scene's `guards`.
//
// No stage and no solver knows of it: the executor tells of each stage that ends
// (Executor::run_with_stage_callback), so that stages to come are looked at, too. A look is a launch of its
// own, of the stage "guard". It reads, and bids by an integer atomic: the minimum of (number of the stage
// within the run, body), which is the same whatever runs it. It never changes the state.
//
//   bounds               the box of each body: a body that is not finite has an empty one
//   contacts             the normals
//   attractor            the accelerations
//   forces, drag, joints, relax, bounce, friction: velocities and spins
//   keys, sort, build, pairs, colour, prepare, continuous, residual, keep: nothing. They write ids, order and
//                        copies, which come to light where a velocity is made of them
//   all others           velocities, spins, positions and orientations
//
// Lives with its pipeline; without the effect there is none.

#include <cstdint>
#include <functional>
#include <vector>

#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/guard/finding.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Where stages write. Pointers are in the executor's memory.
template <class Real>
struct ValidationSource {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const Aabb* boxes;              ///< by body
  const Vector3<Real>* field;     ///< m/s^2, by body; null where nothing pulls
  ContactView<Real> contacts;     ///< control->contacts of them
  std::int64_t contact_capacity;  ///< in contacts
  const StepControl* control;
};

/// What was found first, as the device keeps it.
struct FirstViolation {
  static constexpr std::uint64_t none = ~std::uint64_t{0};
  std::uint64_t key = none;    ///< number of the stage in the run << 32 | body
  std::uint32_t run = 0;       ///< StepControl::committed when that run began
  std::uint32_t is_final = 0;  ///< 1: of a run that has ended; those behind it look no more

  std::uint32_t stage() const { return static_cast<std::uint32_t>(key >> 32); }
  std::uint32_t body() const { return static_cast<std::uint32_t>(key); }
};

/// Squares of what is still sane, as they are compared. A square that overflows is larger than all of them,
/// and NaN is not smaller.
template <class Real>
struct ValidationLimits {
  explicit ValidationLimits(const ValidationSettings& guards)
      : speed(square(guards.speed)),
        distance(square(guards.distance)),
        angular_speed(square(guards.angular_speed)),
        reach(static_cast<float>(guards.distance)) {}

  static Real square(double limit) { return static_cast<Real>(limit) * static_cast<Real>(limit); }
  static SIM_HD bool within(const Vector3<Real>& v, Real square) { return v.dot(v) <= square; }
  static SIM_HD bool finite(const Vector3<Real>& v) {
    return collidoscope::finite(v.x()) && collidoscope::finite(v.y()) && collidoscope::finite(v.z());
  }
  /// Of length 1, but for what rounding makes of it and a factor of sqrt(2).
  static SIM_HD bool about_unit(Real square) { return square >= Real(0.5) && square <= 2; }
  static SIM_HD bool unit(const Vector3<Real>& v) { return about_unit(v.dot(v)); }
  static SIM_HD bool unit(const Quaternion<Real>& q) {
    return about_unit(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
  }
  SIM_HD bool contains(const Aabb& box) const {
    bool good = true;
    for (int k = 0; k < 3; ++k)
      good = good && box.min[k] <= box.max[k] && box.min[k] >= -reach && box.max[k] <= reach;
    return good;
  }

  Real speed;          ///< m^2/s^2
  Real distance;       ///< m^2
  Real angular_speed;  ///< rad^2/s^2
  float reach;         ///< m, of a box along an axis
};

template <class Real>
class StageValidator {
 public:
  StageValidator(Executor& executor, const ValidationSettings& guards);

  /// Enqueues a run, `work`, with looks at what its stages leave in `view`.
  void run_validated(const ValidationSource<Real>& view, const std::function<void()>& work);

  /// Since clear(); waits for the device. In runs that an overflow stopped, boxes alone are looked at.
  FirstViolation first_violation() const { return first_violation_.download()[0]; }
  void clear();

  /// Reads what was found, of one and the same run: the next that is enqueued, which waits for the device
  /// and must not be recorded. Stage, substep, body, quantity and value.
  void describe(const FirstViolation& first_violation) { described_ = first_violation; }
  const Finding& finding() const { return finding_; }

 private:
  void check(const ValidationSource<Real>& view, const char* stage, int substep);
  void describe(const ValidationSource<Real>& view, unsigned parts);

  Executor& executor_;
  ValidationLimits<Real> limits_;
  Buffer<FirstViolation> first_violation_;
  std::uint32_t stages_ = 0;  ///< of the run being enqueued, that have ended
  FirstViolation described_;
  Finding finding_;
};

}  // namespace collidoscope
