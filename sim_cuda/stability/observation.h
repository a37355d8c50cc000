#pragma once
// The view of a run that criteria measure: the current state, read on demand, and the required history. One
// per run, from its first to its last state.

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
  /// Starts at the first state of a run. `assertions` determine the history to keep.
  Observation(World& world, std::span<const Assertion> assertions);

  /// Sets the current state, `seconds` after the first one. `world` must live until the next call.
  void update(World& world, double seconds);

  World& world() const { return *world_; }
  double seconds() const { return seconds_; }
  const StepStats& stats();    ///< of the current state
  const BodyStates& bodies();  ///< of the current state
  const StepStats& first_stats() const { return first_; }
  /// Bodies at the first observed state that is `state` or later. Those of the current state if there is none
  /// yet.
  const BodyStates& bodies_since(std::int64_t state);

  // Running maxima including the current state; computed only if an assertion needs them.
  double energy_scale() const { return energy_scale_; }      ///< J: kinetic + |change of potential energy|
  double momentum_scale() const { return momentum_scale_; }  ///< kg m/s: see momentum_change
  double angular_momentum_scale() const {
    return angular_momentum_scale_;
  }  ///< kg m^2/s: the larger of |L| and the momentum scale times the extent
  /// Pairs of bodies that overlapped at the first state. Filled only if an assertion needs them.
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

/// An overlap of two bodies, or of a body and a fixed object.
struct Overlap {
  std::uint32_t body;
  std::optional<std::uint32_t> other;
  double depth;   ///< m, > 0
  double radius;  ///< m, the smaller radius
};
/// All overlaps of pairs that can collide. Excludes bodies connected by a joint without contacts, and pairs
/// without a dynamic body.
std::vector<Overlap> overlaps(World& world, const BodyStates& bodies);

}  // namespace collidoscope
