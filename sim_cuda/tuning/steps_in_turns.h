#pragma once
// Times steps of several worlds in turns, so that slow drifts of the machine affect all of them alike. All
// comparisons of step times use it: tune, costs of effects, and bench effects. Only refers to the worlds.

#include <cstddef>
#include <vector>

#include "sim_cuda/core/ratio_estimate.h"
#include "sim_cuda/world.h"

namespace collidoscope {

class StepsInTurns {
 public:
  /// Each turn makes `steps` steps in each world. Use an even number: every other step has stage times.
  StepsInTurns(std::vector<World*> worlds, int steps) : worlds_(std::move(worlds)), steps_(steps) {}

  /// Returns ms per step of each world, measured with the host's clock. The order changes as order_of_turn()
  /// says. Throws as World::step does.
  std::vector<double> turn();

 private:
  std::vector<World*> worlds_;
  int steps_;
  std::size_t turns_ = 0;
};

/// Order of `count` worlds in a turn. A step is faster if its own world made the step before, because of
/// caches. In 2 `count` turns, each world is equally often at each position and after itself.
std::vector<std::size_t> order_of_turn(std::size_t count, std::size_t turn);

/// The ratios of times that were measured in the same turns.
std::vector<double> ratios_of(const std::vector<double>& times, const std::vector<double>& references);

}  // namespace collidoscope
