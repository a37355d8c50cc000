#pragma once
// A run as a criterion looks at it: its present state, each part of it read when somebody asks for it, and
// what must be known of the states before. One for a run, from its first state to its last.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim_cuda/measure/step_stats.h"
#include "sim_cuda/stability/criterion.h"
#include "sim_cuda/world.h"

namespace collidoscope {

class Observation {
 public:
  /// At the first state of a run. `assertions` say what is to be remembered on the way.
  Observation(World& world, std::span<const Assertion> assertions);

  /// The run is at another state, `seconds` after its first; `world` lives until the next call.
  void update(World& world, double seconds);

  World& world() const { return *world_; }
  double seconds() const { return seconds_; }
  const StepStats& stats();    ///< now
  const BodyStates& bodies();  ///< now
  const StepStats& first_stats() const { return first_; }
  /// At the first state that was looked at from `state` on; that of now where there is none yet.
  const BodyStates& bodies_since(std::int64_t state);

  // The largest so far, this state included; kept for assertions that ask for them.
  double energy_scale() const { return energy_scale_; }      ///< J: kinetic + |change of the potential|
  double momentum_scale() const { return momentum_scale_; }  ///< kg m/s: sum of m |v|
  double angular_momentum_scale() const {
    return angular_momentum_scale_;
  }  ///< kg m^2/s: |L|, or that times the reach
  /// Bodies that overlapped at the first state; the same.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& overlapping() const { return overlapping_; }

 private:
  void update_scales();

  World* world_;
  double seconds_ = 0;
  std::optional<StepStats> stats_;
  std::optional<BodyStates> bodies_;
  StepStats first_;
  bool energies_ = false, momenta_ = false;
  double energy_scale_ = 0, momentum_scale_ = 0, angular_momentum_scale_ = 0;
  std::map<std::int64_t, std::optional<BodyStates>> since_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> overlapping_;
};

/// One overlap at a state: of two bodies, or of a body and something that never moves.
struct Overlap {
  std::uint32_t body;
  std::optional<std::uint32_t> other;
  double depth;   ///< m, > 0
  double radius;  ///< m, the smaller one
};
/// Of all that can touch: not of bodies that a joint keeps apart, nor of two that no force moves.
std::vector<Overlap> overlaps(World& world, const BodyStates& bodies);

}  // namespace collidoscope
