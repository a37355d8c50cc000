#pragma once
// The effect `sleeping`: islands at rest are neither solved nor moved. Required if a scene has `sleep`: a
// speed in m/s and a time in s.
//
// An island is a connected component of dynamic bodies over joints and the contacts of a step. Contacts
// include all pairs that the motion of the step may bring together. Walls, static and kinematic bodies
// connect nothing and never sleep. A moving kinematic body keeps awake the bodies that it touches.
//
// An island sleeps in a step if the sleep timer of each body has reached the time. The timer runs while
// speed and radius times angular speed are below the limit. Otherwise all its bodies are awake, so no
// contact has only one sleeping body. An island wakes in the step in which a moving body may touch it,
// before contact. Waking resets the sleep timer. A body that falls asleep gets zero velocity. A sleeping
// body keeps its state and cached impulses bit for bit.
//
// Components: ECL-CC (Jaiganesh & Burtscher, 2018). Each body has a parent with a lower or equal id. A
// contact links the larger of its two roots to the smaller by compare-and-swap; lookups halve the path. The
// final root is the least id of its component, independent of thread order.
//
// Owned by the solver; without the effect it uses no memory.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/hashed_arrays.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/solver/joint_state.h"

namespace collidoscope {

/// Value of a sleep timer: the body is asleep.
inline constexpr std::uint32_t asleep_marker = 0xffffffffu;

/// Sleep state of bodies, for display.
struct SleepView {
  const std::uint32_t* sleep_timer =
      nullptr;                       ///< by body, steps below the speed limit; null without the effect
  std::uint32_t steps_to_sleep = 1;  ///< timer value at which an island may sleep

  /// 0: asleep. 1/4 to 1: awake; 1/4 if the timer has reached the time, 1 if it is zero.
  SIM_HD float distance(int body) const {
    if (sleep_timer == nullptr || sleep_timer[body] == 0) return 1;
    if (sleep_timer[body] == asleep_marker) return 0;
    return 1 - 0.75f * static_cast<float>(min_of(sleep_timer[body], steps_to_sleep)) /
                   static_cast<float>(steps_to_sleep);
  }
};

/// Counts of sleeping bodies and of islands.
struct SleepSums {
  std::int64_t asleep, islands, islands_asleep;
};
SIM_HD inline SleepSums combine(SleepSums a, SleepSums b) {
  return {a.asleep + b.asleep, a.islands + b.islands, a.islands_asleep + b.islands_asleep};
}

template <class Real>
class Sleeping {
 public:
  explicit Sleeping(Executor& executor);
  /// Call once, if the effect is on; `time_step` in s.
  void enable(const BodyView<Real>& bodies, std::int64_t body_count, const Sleep& sleep, double time_step,
              const StepControl* control);

  /// By body, 1 if asleep in this run; null without the effect.
  const std::uint8_t* asleep() const { return asleep_.data(); }

  /// Call in each run after contacts are found (`contact_capacity` at most). Decides which islands sleep.
  void find_islands(const ContactView<Real>& contacts, std::int64_t contact_capacity,
                    const JointView<Real>& joints);
  /// Call at the end of a run. Updates the sleep timers.
  void update_timers();

  /// Counts sleeping bodies, and islands of the last run; 0 islands before the first run.
  SleepSums measure() const;
  SleepView view() const { return {sleep_timer_.data(), steps_to_sleep_}; }

  /// Sleep timers in steps, or asleep_marker; empty without the effect.
  std::vector<std::uint32_t> save_warm_start() const { return sleep_timer_.download(); }
  /// Bodies that are not in `sleep_timer` start with 0.
  void load_warm_start(std::vector<std::uint32_t> sleep_timer);
  void visit_warm_start(const ArrayVisitor& visit) const {
    visit(sleep_timer_.data(), sleep_timer_.bytes());
    visit(parent_.data(), parent_.bytes());
  }
  void list_warm_start(HashedArrays& arrays) const {
    if (sleep_timer_.size() > 0)
      arrays.add<std::uint32_t>(sleep_timer_.data(), static_cast<std::int64_t>(sleep_timer_.size()));
  }

 private:
  Executor& executor_;
  BodyView<Real> bodies_{};
  std::int64_t body_count_ = 0;
  Real speed_ = 0;                    ///< m/s
  std::uint32_t steps_to_sleep_ = 1;  ///< steps
  const StepControl* control_ = nullptr;
  Buffer<std::uint32_t> sleep_timer_;            ///< by body, steps
  Buffer<std::uint32_t> parent_;                 ///< by body; a root is its own parent
  Buffer<std::uint8_t> island_active_, asleep_;  ///< by root; by body
  Buffer<SleepSums> sums_;
};

}  // namespace collidoscope
