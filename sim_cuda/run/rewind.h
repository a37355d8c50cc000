#pragma once
// Brings a run back to a state that it came through. Keeps one copy of where the run stood, on the host, and
// steps again from there, which leads to the same bits (the first promise). Copies are made so seldom that
// they take at most a fiftieth of the time that passes; going back takes fifty times as long as one copy,
// about, and the step that was under way.
//
// Follows one run of one world; owned by who steps it.

#include <chrono>
#include <cstdint>
#include <optional>

#include "sim_cuda/run/run_state.h"

namespace collidoscope {

class Rewind {
 public:
  /// Before each step: copies where the world stands, if that is due.
  void before_step(World& world);
  /// To a state that is no older than the last forget(), and no newer than the world.
  void to(World& world, std::int64_t step);
  /// The world is another, or in another state, than its steps have led to. Does nothing within to().
  void forget();

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<RunState> copy_;
  Clock::time_point made_{};
  Clock::duration cost_{};
  bool going_back_ = false;
};

}  // namespace collidoscope
