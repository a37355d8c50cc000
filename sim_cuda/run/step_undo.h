#pragma once
// How a cancelled step commits nothing, on the CPU, where stages write to the state itself. Up to its
// contacts a step writes nothing that outlives it. What follows is not interrupted where it is short; where
// it may be long, a copy of what it writes is put aside first. Belongs to a World.

#include <optional>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/run/pipeline.h"

namespace collidoscope {

class StepUndo {
 public:
  explicit StepUndo(Executor& executor) : executor_(executor) {}

  /// A step of so many pipeline runs begins. Nothing happens without a cancellation.
  void begin_step(int runs);
  /// The first of its runs, or a later one, is about to write; `solve_seconds`: what solving a run's contacts
  /// is expected to take.
  void before_writing(Pipeline& pipeline, const StepControl& control, double solve_seconds);
  /// The step is done, or has failed otherwise than by being cancelled.
  void end_step();
  /// The step was cancelled.
  void cancel_step();
  /// After that: the state is as it was before that step; all that does not outlive steps is lost.
  void undo();

 private:
  Executor& executor_;
  Cancellation::Clock::time_point start_{};  ///< of a step of several runs
  int runs_ = 1;
  bool in_step_ = false;
  HostBackup backup_;
  std::optional<Executor::Uninterrupted> to_the_end_;
};

}  // namespace collidoscope
