#pragma once
// Stops of a live run: violations found by guards, and break conditions. Each step is measured for the graphs
// in any case, so a condition costs a comparison. While conditions are on, a copy of the run is saved at
// intervals (run/checkpoint.h) to restore the state before a stop. Follows one LiveWorld.

#include <array>
#include <optional>

#include "sim_cuda/run/checkpoint.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "sim_cuda/world.h"
#include "ui/break_view.h"
#include "viewer/session/live_world.h"

namespace collidoscope {

class LiveBreakpoints {
 public:
  void before_step(LiveWorld& live, const BreakConditions& conditions);
  /// Call after a step or a refused step. Returns whether the run stops here. After resume(), a condition
  /// must first become false before it stops the run again.
  bool after_step(LiveWorld& live, const BreakConditions& conditions);

  /// The present stop; unset after the run was resumed or replaced.
  const std::optional<StopView>& stop(const LiveWorld& live);
  void resume() { stop_.reset(); }
  /// Snapshot of the state before the step that led to the stop. The run does not change. Throws InputError
  /// if that state cannot be restored.
  Snapshot snapshot_before(LiveWorld& live);

 private:
  void follow(const LiveWorld& live);
  void stop_at(LiveWorld& live, StopView stop);

  int generation_ = -1;
  std::optional<BreakpointMonitor> monitor_;
  Checkpoint checkpoint_;
  std::array<bool, break_condition_names.size()> suppressed_{};
  std::optional<StopView> stop_;
  bool cannot_restore_ = false;
};

}  // namespace collidoscope
