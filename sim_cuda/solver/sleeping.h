#pragma once
// The effect `sleeping`: islands at rest are neither solved nor moved. Called for by a scene's `sleep`: a
// speed in m/s and a time in s.
//
// An island is a connected component of bodies over joints and over the contacts of a step, which are all
// that its motion may bring together. Walls, and bodies that no force moves, join nothing and never sleep;
// one of the latter that moves keeps awake what it touches. It sleeps in a step where each of its bodies has
// been slow, in speed and in radius times spin, for at least the time; where one has not, all are awake, so
// that no contact ever has one side asleep. So an island wakes in the very step in which something that moves
// may touch it, before that does; and who is woken is slow from then on anew. Who falls asleep loses what
// speed is left; who sleeps keeps its state, and what is remembered of its contacts, bit for bit.
//
// Components: ECL-CC (Jaiganesh & Burtscher, 2018). Each body points to one with a lower id; a contact hangs
// the greater of its two roots under the lesser by compare-and-swap, halving paths on its way. The last root
// is the least id of its component, whatever the order of arrival.
//
// Owned by the solver; without the effect it has no memory.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/solver/joint_state.h"

namespace collidoscope {

/// In place of a number of steps: the body sleeps.
inline constexpr std::uint32_t asleep_marker = 0xffffffffu;

/// For pictures: how far each body is from sleep.
struct SleepView {
  const std::uint32_t* sleep_timer =
      nullptr;                       ///< by body, steps for which it was slow; null: nothing can sleep
  std::uint32_t steps_to_sleep = 1;  ///< of these, before an island may sleep

  /// 0: asleep; 1/4 to 1: awake, and at rest for all of the time to not at all.
  SIM_HD float distance(int body) const {
    if (sleep_timer == nullptr || sleep_timer[body] == 0) return 1;
    if (sleep_timer[body] == asleep_marker) return 0;
    return 1 - 0.75f * static_cast<float>(min_of(sleep_timer[body], steps_to_sleep)) /
                   static_cast<float>(steps_to_sleep);
  }
};

/// What is counted of all bodies.
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
  /// Once, where the effect is on; `time_step` in s.
  void enable(const BodyView<Real>& bodies, std::int64_t body_count, const Sleep& sleep, double time_step,
              const StepControl* control);

  /// By body, 1: asleep in this run; null without the effect.
  const std::uint8_t* asleep() const { return asleep_.data(); }

  /// In each run, once its contacts are known, `contact_capacity` at most: who sleeps.
  void find_islands(const ContactView<Real>& contacts, std::int64_t contact_capacity,
                    const JointView<Real>& joints);
  /// At the end of a run: counts for how long each body has been slow.
  void update_timers();

  /// Counts who sleeps, and the islands of the last run: none before the first.
  SleepSums measure() const;
  SleepView view() const { return {sleep_timer_.data(), steps_to_sleep_}; }

  /// Steps for which each body has been slow, or asleep_marker; empty without the effect.
  std::vector<std::uint32_t> save_warm_start() const { return sleep_timer_.download(); }
  /// Bodies beyond those that are known, all of them if none are, have not been slow yet.
  void load_warm_start(std::vector<std::uint32_t> sleep_timer);
  void visit_warm_start(const ArrayVisitor& visit) const { visit(sleep_timer_.data(), sleep_timer_.bytes()); }

 private:
  Executor& executor_;
  BodyView<Real> bodies_{};
  std::int64_t body_count_ = 0;
  Real speed_ = 0;                    ///< m/s
  std::uint32_t steps_to_sleep_ = 1;  ///< steps
  const StepControl* control_ = nullptr;
  Buffer<std::uint32_t> sleep_timer_;            ///< by body
  Buffer<std::uint32_t> parent_;                 ///< by body; at the root itself
  Buffer<std::uint8_t> island_active_, asleep_;  ///< by root; by body
  Buffer<SleepSums> sums_;
};

}  // namespace collidoscope
