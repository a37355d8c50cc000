#pragma once
// Brings a run back to a state that it came through. Keeps one copy of where the run stood, on the host, and
// steps again from there, which leads to the same bits (the first promise). Copies are made so seldom that
// they take at most a fiftieth of the time that passes; going back takes fifty times as long as one copy,
// about, and the step that was under way.
//
// Follows one run of one world; owned by who steps it.

#include <chrono>
#include <concepts>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "sim_cuda/run/run_state.h"

namespace collidoscope {

/// A World, or what steps as one.
template <class Run>
concept Steppable = requires(Run& run, const RunState& state, int count) {
  { run.state() } -> std::same_as<RunState>;
  run.adopt(state);
  run.step(count);
};

class Rewind {
 public:
  /// Before each step: copies where the world stands, if that is due.
  void before_step(Steppable auto& world) {
    constexpr int dear = 50;  // times as long as a copy takes, until the next
    const Clock::time_point now = Clock::now();
    if (going_back_ || (copy_ && now - made_ < dear * cost_)) return;
    copy_ = world.state();
    made_ = Clock::now();
    cost_ = made_ - now;
  }
  /// To a state that is no older than the last forget(), and no newer than the world.
  void to(Steppable auto& world, std::int64_t step) {
    if (!copy_ || step < copy_->steps)
      throw std::logic_error("rewind: state " + std::to_string(step) + " was not followed");
    struct ResetOnExit {  // however it ends
      bool& on;
      ~ResetOnExit() { on = false; }
    } back{going_back_};
    going_back_ = true;
    world.adopt(*copy_);
    world.step(static_cast<int>(step - copy_->steps));
  }
  /// The world is another, or in another state, than its steps have led to. Does nothing within to().
  void forget() {
    if (!going_back_) copy_.reset();
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<RunState> copy_;
  Clock::time_point made_{};
  Clock::duration cost_{};
  bool going_back_ = false;
};

}  // namespace collidoscope
