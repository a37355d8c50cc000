#pragma once
// Times steps of several worlds in turns, so that slow drifts of the machine affect all of them alike. All
// comparisons of step times use it: tune, costs of effects, and bench effects. Only refers to the worlds.

#include <vector>

#include "sim_cuda/core/ratio_estimate.h"
#include "sim_cuda/world.h"

namespace collidoscope {

class StepsInTurns {
 public:
  /// Each turn makes `steps` steps in each world. Use an even number: every other step has stage times.
  StepsInTurns(std::vector<World*> worlds, int steps) : worlds_(std::move(worlds)), steps_(steps) {}

  /// Returns ms per step of each world, measured with the host's clock. Every second turn is in reverse
  /// order, because a world may find the caches of the processor as the one before left them. Throws as
  /// World::step does.
  std::vector<double> turn();

 private:
  std::vector<World*> worlds_;
  int steps_;
  bool reverse_ = false;
};

/// The ratios of times that were measured in the same turns.
std::vector<double> ratios_of(const std::vector<double>& times, const std::vector<double>& references);

}  // namespace collidoscope
