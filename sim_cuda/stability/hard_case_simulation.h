#pragma once
// One run of a hard case: a world with scheduled changes and an optional injected body state. Owns its world.

#include <cstdint>
#include <optional>
#include <vector>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/stability/criterion.h"
#include "sim_cuda/world.h"

namespace collidoscope {

class HardCaseSimulation {
 public:
  /// `changes` must be sorted by step. Throws the same exceptions as World.
  HardCaseSimulation(Scene scene, RunOptions options, std::vector<Change> changes = {},
                     std::optional<InjectedState> injected = std::nullopt);

  /// Makes one step, then applies the changes and the injection scheduled for the new state. No effect if
  /// guards pause the run.
  void step();
  std::int64_t state() const { return world_->steps(); }
  double seconds() const { return seconds_; }  ///< s, simulated
  World& world() { return *world_; }

 private:
  void make_due();

  std::vector<Change> changes_;
  std::size_t next_ = 0;
  std::optional<InjectedState> injected_;
  std::unique_ptr<World> world_;
  double seconds_ = 0;
};

}  // namespace collidoscope
