#pragma once
// The effect `guards`: checks the output of each stage of a step. Keeps the first value that is not finite
// or exceeds a limit of the scene's `guards`. The order is by stage, then by body id. Required if a scene
// has `guards`.
//
// Solvers and stages contain no check. The executor reports each finished stage
// (Executor::run_with_stage_callback), so new stages are checked automatically. A check is a launch of the
// stage "guard". It only reads, and reports a violation by an integer atomic minimum of (stage number in
// the run, body). The result is the same on every executor, and the state never changes. Checked values by
// stage:
//
//   bounds               boxes; the box of a non-finite body is empty
//   contacts             normals
//   attractor            accelerations
//   forces, drag, joints, relax, bounce: velocities and angular velocities
//   keys, sort, build, pairs, colour, prepare, continuous, residual, keep: nothing (ids, order and copies)
//   all others           velocities, angular velocities, positions and orientations
//
// Lives with its pipeline, which creates one only with the effect.

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

/// Buffers that the stages write, in the executor's memory.
template <class Real>
struct ValidationSource {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const Aabb* boxes;              ///< by body
  const Vector3<Real>* field;     ///< acceleration by attractors, m/s^2, by body; null without attractors
  ContactView<Real> contacts;     ///< control->contacts contacts
  std::int64_t contact_capacity;  ///< in contacts
  const StepControl* control;
};

/// The first violation, as stored on the device.
struct FirstViolation {
  static constexpr std::uint64_t none = ~std::uint64_t{0};
  std::uint64_t key = none;    ///< stage number in the run << 32 | body
  std::uint32_t run = 0;       ///< StepControl::committed at the start of that run
  std::uint32_t is_final = 0;  ///< 1: that run has ended; later runs are not checked

  std::uint32_t stage() const { return static_cast<std::uint32_t>(key >> 32); }
  std::uint32_t body() const { return static_cast<std::uint32_t>(key); }
};

/// Squared limits. A square that overflows exceeds every limit, and NaN fails every comparison.
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
  /// True if the length is 1 within a factor of sqrt(2).
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
  float reach;         ///< largest coordinate of a box, m
};

template <class Real>
class StageValidator {
 public:
  StageValidator(Executor& executor, const ValidationSettings& guards);

  /// Enqueues the run `work`, with a check after each of its stages.
  void run_validated(const ValidationSource<Real>& view, const std::function<void()>& work);

  /// First violation since clear(); waits for the device. In a run that stopped at an overflow, only boxes
  /// are checked.
  FirstViolation first_violation() const { return first_violation_.download()[0]; }
  void clear();

  /// Fills finding() with stage, substep, body, quantity and value of a violation. The next enqueued run
  /// must be the same run again. It waits for the device and must not be recorded.
  void describe(const FirstViolation& first_violation) { described_ = first_violation; }
  const Finding& finding() const { return finding_; }

 private:
  void check(const ValidationSource<Real>& view, const char* stage, int substep);
  void describe(const ValidationSource<Real>& view, unsigned parts);

  Executor& executor_;
  ValidationLimits<Real> limits_;
  Buffer<FirstViolation> first_violation_;
  std::uint32_t stages_ = 0;  ///< number of finished stages of the run being enqueued
  FirstViolation described_;
  Finding finding_;
};

}  // namespace collidoscope
