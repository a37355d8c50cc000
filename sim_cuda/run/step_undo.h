#pragma once
// Undo of a cancelled step on the CPU, where stages write directly to the state. Stages up to the contacts
// write no persistent data. The rest of the step is not interrupted if it is short. If it may be long, the
// persistent arrays are copied first. Owned by a Simulation.

#include <optional>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/run/pipeline.h"

namespace collidoscope {

class StepUndo {
 public:
  explicit StepUndo(Executor& executor) : executor_(executor) {}

  /// Starts a step of `runs` pipeline runs. No effect without a cancellation object.
  void begin_step(int runs);
  /// Call before a run writes persistent arrays. `solve_seconds`: expected time for solving the contacts of
  /// a run, s.
  void before_writing(Pipeline& pipeline, const StepControl& control, double solve_seconds);
  /// Ends a step that succeeded or failed, but was not cancelled.
  void end_step();
  /// Ends a cancelled step.
  void cancel_step();
  /// Call after cancel_step(). Restores the persistent arrays of before the step; other data are lost.
  void undo();

 private:
  Executor& executor_;
  Cancellation::Clock::time_point start_{};  ///< start of a step with several runs
  int runs_ = 1;
  bool in_step_ = false;
  HostBackup backup_;
  std::optional<Executor::Uninterrupted> to_the_end_;
};

}  // namespace collidoscope
