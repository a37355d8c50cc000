#pragma once
// Two worlds that start from copies of one state and make the same steps in turns, so that slow drifts of the
// machine cancel. The reference has the present settings, the candidate others. Owns both worlds.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/world.h"

namespace collidoscope {

class PairedSteps {
 public:
  /// Copies the present state of `world`, which is only read. Throws as World does.
  explicit PairedSteps(World& world);

  World& reference() { return *reference_; }
  World& candidate() { return *candidate_; }
  const World& reference() const { return *reference_; }
  const World& candidate() const { return *candidate_; }
  /// Replaces the candidate. With other physical settings, do not compare the states. Throws as World does;
  /// then there is no candidate.
  void replace_candidate(const Scene& scene, const RunOptions& options);

  /// Steps of a measurement: one timed as a whole, and one timed by stage.
  static constexpr int steps_of_pair = 2;
  using Clock = std::chrono::steady_clock;
  struct Durations {
    double benchmark = 0, check = 0;  ///< ms: all pairs; comparison of the states
  };
  /// Returns both worlds to the state and measures up to `pairs` pairs, at least one, until `end`. Calls
  /// `note` with the times of each pair, in ms per step: candidate, reference. Throws Cancelled.
  Durations measure(int pairs, Clock::time_point end, const std::function<void(double, double)>& note);
  /// "", or how the states differ after measure(). Adds its time.
  std::string difference(Durations& durations);

  /// Replaces World::state_hash(). For tests.
  void set_hash(std::function<std::uint64_t(World&)> hash) { hash_ = std::move(hash); }

 private:
  RunState state_;  ///< also marked in both worlds; for the case that rewind() fails
  std::unique_ptr<World> reference_, candidate_;
  std::function<std::uint64_t(World&)> hash_;
};

}  // namespace collidoscope
