#pragma once
// A step, recorded once and launched often.

#include <cstddef>
#include <functional>
#include <vector>

#if SIM_CUDA
#include "sim_cuda/core/cuda_check.h"
#endif

namespace collidoscope {

class Executor;

/// A step, recorded once and launched often: a CUDA graph, or on the CPU simply the function. If it is
/// instrumented, it also measures each of its stages.
class StepGraph {
 public:
  /// `enqueue` runs stages on `executor`; it must not allocate, copy to or from the host, or wait.
  StepGraph(Executor& executor, bool instrumented, std::function<void()> enqueue);
  ~StepGraph();
  StepGraph(const StepGraph&) = delete;
  StepGraph& operator=(const StepGraph&) = delete;

  void launch();
  /// After an instrumented launch has finished: adds its times to the executor's clock (which still needs
  /// commit_step()).
  void collect();

 private:
  Executor& executor_;
  bool instrumented_;
  std::function<void()> enqueue_;
#if SIM_CUDA
  void mark(std::size_t entry);
  cudaGraphExec_t graph_ = nullptr;
  std::vector<cudaEvent_t> events_;         ///< one at the start of each run of a stage, one at the end
  std::vector<std::size_t> event_entries_;  ///< index in the clock of the stage that starts there
#endif
};

}  // namespace collidoscope
