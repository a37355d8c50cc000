#pragma once
// Recording of a step as a CUDA graph, which is launched many times. Owns the graph and its events. The
// executor must outlive it.

#include <cstddef>
#include <functional>
#include <vector>

#if SIM_CUDA
#include "sim_cuda/core/cuda_check.h"
#endif

namespace collidoscope {

class Executor;

/// A CUDA graph of a step; on the CPU, the function itself. An instrumented graph also measures each stage.
class StepGraph {
 public:
  /// `enqueue` runs stages on `executor`. It must not allocate, copy to or from the host, or wait.
  StepGraph(Executor& executor, bool instrumented, std::function<void()> enqueue);
  ~StepGraph();
  StepGraph(const StepGraph&) = delete;
  StepGraph& operator=(const StepGraph&) = delete;

  void launch();
  /// Adds the times of an instrumented launch to the executor's clock. Call it after the launch has finished,
  /// and before commit_step().
  void collect();

 private:
  Executor& executor_;
  bool instrumented_;
  std::function<void()> enqueue_;
#if SIM_CUDA
  void mark(std::size_t entry);
  cudaGraphExec_t graph_ = nullptr;
  std::vector<cudaEvent_t> events_;         ///< one at the start of each stage run, and one at the end
  std::vector<std::size_t> event_entries_;  ///< clock index of the stage that starts at the event
#endif
};

}  // namespace collidoscope
