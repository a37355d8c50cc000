#pragma once
// Where a live run stops for somebody to look: at what its guards found, or where a condition is met. A step
// is measured for the graphs anyway, so that conditions cost a comparison, and none at all while they are
// off; but a copy of the run now and then (run/checkpoint.h), to come back to the state before. Follows one
// LiveWorld.

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
  /// After a step, or an attempt: whether the run is to stop here. A condition that somebody went on from is
  /// met anew only after a state in which it was not.
  bool after_step(LiveWorld& live, const BreakConditions& conditions);

  /// At what the run stands; gone where it becomes another run, or goes on.
  const std::optional<StopView>& stop(const LiveWorld& live);
  void resume() { stop_.reset(); }
  /// The state before the step that stop() is about. The run stays where it is. Throws InputError where there
  /// is no way back.
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
