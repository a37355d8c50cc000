#pragma once
// Returns a run to an earlier state. Keeps one copy of the run's state on the host, and repeats the steps
// from there, which gives the same bits. A new copy is made only after 50 times the duration of the last
// copy, so copies take at most 1/50 of the time. A return takes about 50 times the duration of a copy, plus
// the step in progress.
//
// Used for one run of one world; owned by the class that steps it.

#include <chrono>
#include <concepts>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "sim_cuda/run/run_state.h"

namespace collidoscope {

/// A World, or a class with the same interface.
template <class Run>
concept Steppable = requires(Run& run, const RunState& state, int count) {
  { run.state() } -> std::same_as<RunState>;
  run.restore(state);
  run.step(count);
};

class Checkpoint {
 public:
  /// Call before each step. Copies the state if a copy is due.
  void save_if_due(Steppable auto& world) {
    constexpr int copy_interval_factor = 50;  // interval between copies, in durations of a copy
    const Clock::time_point now = Clock::now();
    if (restoring_ || (copy_ && now - made_ < copy_interval_factor * cost_)) return;
    copy_ = world.state();
    made_ = Clock::now();
    cost_ = made_ - now;
  }
  /// Returns to state `step`. Precondition: it is not older than the copy and not newer than the current
  /// state. Throws std::logic_error without such a copy.
  void restore(Steppable auto& world, std::int64_t step) {
    if (!copy_ || step < copy_->steps)
      throw std::logic_error("rewind: no checkpoint at or before state " + std::to_string(step));
    struct ResetOnExit {  // also on exceptions
      bool& on;
      ~ResetOnExit() { on = false; }
    } back{restoring_};
    restoring_ = true;
    world.restore(*copy_);
    world.step(static_cast<int>(step - copy_->steps));
  }
  /// Discards the copy. Call if the world is replaced or its state is set. No effect during restore().
  void clear() {
    if (!restoring_) copy_.reset();
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<RunState> copy_;
  Clock::time_point made_{};
  Clock::duration cost_{};
  bool restoring_ = false;
};

}  // namespace collidoscope
