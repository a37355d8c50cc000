#pragma once
// One run of a hard case: a world that steps from state to state, with the changes of its file and, where
// somebody asked for it, a body set to something at a state. Owns its world.

#include <cstdint>
#include <optional>
#include <vector>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/stability/criterion.h"
#include "sim_cuda/world.h"

namespace collidoscope {

class HardCaseSimulation {
 public:
  /// `changes`: steps ascending. Throws as World does.
  HardCaseSimulation(Scene scene, RunOptions options, std::vector<Change> changes = {},
                     std::optional<InjectedState> injected = std::nullopt);

  /// One step, what is changed at the state that it comes to, and what is injected there. Nothing where the
  /// scene's guards pause.
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
