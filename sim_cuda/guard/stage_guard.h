#pragma once
// The effect `guards`: after each stage that writes quantities with units, a look at all that it wrote. The
// first value that is not finite, or beyond what the scene's `guards` allow, is kept: first in the order of
// the stages of a step, and among those of one stage of the lowest body. Called for by a scene's `guards`.
//
// No stage and no solver knows of it: the executor tells of each stage that ends (Executor::run_watched), so
// that stages to come are looked at, too. A look is a launch of its own, of the stage "guard". It reads, and
// bids by an integer atomic: the minimum of (number of the stage within the run, body), which is the same
// whatever runs it. It never changes the state.
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
struct GuardedView {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const Aabb* boxes;              ///< by body
  const Vector3<Real>* field;     ///< m/s^2, by body; null where nothing pulls
  ContactView<Real> contacts;     ///< control->contacts of them
  std::int64_t contact_capacity;  ///< in contacts
  const StepControl* control;
};

/// What was found first, as the device keeps it.
struct FirstFound {
  static constexpr std::uint64_t none = ~std::uint64_t{0};
  std::uint64_t key = none;   ///< number of the stage in the run << 32 | body
  std::uint32_t run = 0;      ///< StepControl::committed when that run began
  std::uint32_t settled = 0;  ///< 1: of a run that has ended; those behind it look no more

  std::uint32_t stage() const { return static_cast<std::uint32_t>(key >> 32); }
  std::uint32_t body() const { return static_cast<std::uint32_t>(key); }
};

/// Squares of what is still sane, as they are compared. A square that overflows is larger than all of them,
/// and NaN is not smaller.
template <class Real>
struct SaneLimits {
  explicit SaneLimits(const Guards& guards)
      : speed(square(guards.speed)),
        distance(square(guards.distance)),
        spin(square(guards.spin)),
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
  SIM_HD bool holds(const Aabb& box) const {
    bool good = true;
    for (int k = 0; k < 3; ++k)
      good = good && box.min[k] <= box.max[k] && box.min[k] >= -reach && box.max[k] <= reach;
    return good;
  }

  Real speed;     ///< m^2/s^2
  Real distance;  ///< m^2
  Real spin;      ///< rad^2/s^2
  float reach;    ///< m, of a box along an axis
};

template <class Real>
class StageGuard {
 public:
  StageGuard(Executor& executor, const Guards& guards);

  /// Enqueues a run, `work`, with looks at what its stages leave in `view`.
  void watch(const GuardedView<Real>& view, const std::function<void()>& work);

  /// Since forget(); waits for the device. In runs that an overflow stopped, boxes alone are looked at.
  FirstFound found() const { return found_.download()[0]; }
  void forget();

  /// Reads what was found, of one and the same run: the next that is enqueued, which waits for the device
  /// and must not be recorded. Stage, substep, body, quantity and value.
  void read(const FirstFound& found) { wanted_ = found; }
  const Finding& finding() const { return finding_; }

 private:
  void look(const GuardedView<Real>& view, const char* stage, int substep);
  void read(const GuardedView<Real>& view, unsigned parts);

  Executor& executor_;
  SaneLimits<Real> limits_;
  Buffer<FirstFound> found_;
  std::uint32_t stages_ = 0;  ///< of the run being enqueued, that have ended
  FirstFound wanted_;
  Finding finding_;
};

}  // namespace collidoscope
