#pragma once
// Runs the pipeline of a world step by step. A step is recorded once and replayed, as a whole or with stage
// timing. A list that overflows grows, and the stopped run is repeated, so no pair or contact is lost.
// Owned by a Simulation.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "sim_cuda/core/executor.h"
#include "sim_cuda/run/pipeline.h"

namespace collidoscope {

class StepRunner {
 public:
  /// `pipeline`: without capacity. `capacity`: initial capacities.
  StepRunner(Executor& executor, std::unique_ptr<Pipeline> pipeline, Capacity capacity);

  Pipeline& pipeline() { return *pipeline_; }
  const Pipeline& pipeline() const { return *pipeline_; }
  /// Discards recorded steps. Call before each change of the stages or buffers of a step.
  void discard_graphs();
  /// Replaces the pipeline. Precondition: the new one has its capacities.
  void replace(std::unique_ptr<Pipeline> pipeline);
  /// Replaces the pipeline after a run was cancelled halfway. The lists of the old pipeline are freed
  /// first, then `make` creates the new one.
  void recreate(const std::function<std::unique_ptr<Pipeline>()>& make);

  /// After the last complete step.
  const StepControl& control() const { return control_; }
  /// Number of committed pipeline runs, modulo 2^32.
  std::uint32_t committed() const { return committed_; }
  /// Value of committed() after one more step.
  std::uint32_t next() const { return committed_ + static_cast<std::uint32_t>(pipeline_->runs_per_step()); }
  /// Makes one step; `timed`: with stage timing. If guards find a violation, returns it after part of the
  /// step. Throws MachineError if memory is insufficient; the state is then unchanged. Exception: if a run
  /// failed halfway, no further step is possible. Throws Cancelled; the caller must then call recreate().
  std::optional<FirstViolation> step(bool timed);
  /// Finds boxes, pairs and contacts of the current state; lists grow as in a step.
  void detect();
  /// Call after runs that must not enter the state.
  void discard_runs();

  /// Throws MachineError if no step is possible.
  void require_memory() const;

 private:
  void reserve(Capacity capacity);
  std::int64_t missing_bytes(Capacity capacity);
  bool grow();
  void launch(StepGraph& graph);
  StepGraph& graph(bool timed);
  bool run_plain(std::uint32_t target);
  bool run_timed(std::uint32_t target);

  Executor& executor_;
  std::unique_ptr<Pipeline> pipeline_;
  std::unique_ptr<StepGraph> plain_, timed_;
  std::uint32_t committed_ = 0;
  StepControl control_{};
  bool is_unusable_ = false;  ///< the state is lost, or memory for existing lists is missing
};

}  // namespace collidoscope
