#pragma once
// Runs the pipeline of a world step by step. A step is recorded once and replayed: plain, or with a time
// taken after each stage. Lists that turn out too small grow, and the run that they stopped is done again, so
// that nothing is ever dropped.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "sim_cuda/core/executor.h"
#include "sim_cuda/run/pipeline.h"

namespace collidoscope {

class StepRunner {
 public:
  /// `pipeline` has reserved nothing yet; its lists begin at `capacity`.
  StepRunner(Executor& executor, std::unique_ptr<Pipeline> pipeline, Capacity capacity);

  Pipeline& pipeline() { return *pipeline_; }
  const Pipeline& pipeline() const { return *pipeline_; }
  /// Whatever changes what a step does comes after this.
  void discard_graphs();
  /// Goes on with another, which has reserved what it needs.
  void replace(std::unique_ptr<Pipeline> pipeline);
  /// The same after a run was cancelled in its middle: with one that `make` makes, for which the lists of the
  /// old one, whose contents are lost, make room.
  void recreate(const std::function<std::unique_ptr<Pipeline>()>& make);

  /// Pipeline runs whose result is in the state, modulo 2^32.
  std::uint32_t committed() const { return committed_; }
  /// What committed() is after one more step.
  std::uint32_t next() const { return committed_ + static_cast<std::uint32_t>(pipeline_->runs_per_step()); }
  /// Does one step, up to next() at the time of the call, `timed` or plain; or, with what guards found in it,
  /// a part of one. Throws MachineError where memory does not suffice: then nothing has changed, unless a run
  /// ended in its middle, after which no step can be made. Throws Cancelled, after which recreate() comes
  /// next.
  std::optional<FirstViolation> step(bool timed);
  /// Finds boxes, pairs and contacts, which grow as for a step.
  void detect();
  /// After runs that are not to be in the state.
  void discard_runs();

  /// Throws MachineError where no step can be made.
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
  bool is_unusable_ = false;  ///< no state to go on from, or no memory for what was already there
};

}  // namespace collidoscope
