#pragma once
// Tracks the stage in progress and records it in the StageClock: times on the CPU, launches on CPU and GPU.
// GPU times are measured by events in a captured graph (step_graph.h).

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "sim_cuda/core/stage_clock.h"

#if SIM_CUDA
#include "sim_cuda/core/cuda_check.h"
#endif

namespace collidoscope {

class StageRecorder {
 public:
  /// Called when all work of a stage has been enqueued, with the substep in which the stage began.
  using StageCallback = std::function<void(const char* stage, int substep)>;

  StageClock& clock() { return clock_; }

  /// Ends the stage in progress and begins `name`; no effect if `name` is already in progress.
  /// `library_launch`: (B, T) does not apply to the stage.
  void begin(const char* name, bool library_launch);
  void end();
  /// Until the next call, all stages that begin are parts of the stage `name`; null: ends this.
  void merge_into(const char* name) { merged_ = name; }
  /// The name of the stage in progress, or null.
  const char* stage() const { return stage_; }
  /// Sets the substep index (from 0) of the stages that begin afterwards.
  void begin_substep(int substep) { substep_ = substep; }
  /// Calls `work`, and `ended` after each of its stages. `ended` is not called for stages that it begins.
  /// The substep index starts at 0.
  void run_with_stage_callback(const StageCallback& ended, const std::function<void()>& work);

  // CPU: steps run immediately. begin_step() clears the launch counts and shapes of the previous step.
  void begin_step(bool timed);
  void end_step();
  void cancel_step();  ///< call this if a step threw Cancelled

  bool counting() const { return counting_; }
  void count_launches(int launches);
  /// CPU: records one more parallel loop of the stage in progress. Ignored without a stage, or if launches
  /// are not counted.
  void count_loop(const StageLaunch& loop);

#if SIM_CUDA
  // GPU: a step is captured as a graph.

  /// Called at the start of each stage with the clock index of the stage.
  using StageBeginCallback = std::function<void(std::size_t entry)>;
  /// `stream` is being captured. With `began` the step is instrumented. If `began` is null, the launches of
  /// each stage are counted.
  void begin_capture(cudaStream_t stream, StageBeginCallback began);
  void end_capture();
  void drop_capture();  ///< call this if the capture failed; also clears the stage in progress
  /// Records a kernel of the stage in progress. Ignored outside of a capture.
  void note_launch(const StageLaunch& launch);
#endif

 private:
  void close();

  StageClock clock_;
  const char* stage_ = nullptr;   ///< the stage in progress, or null
  const char* merged_ = nullptr;  ///< see merge_into()
  std::size_t stage_entry_ = 0;
  int substep_ = 0, stage_substep_ = 0;
  const StageCallback* stage_callback_ = nullptr;  ///< null: no callback, or the callback is running
  bool timing_ = false;                            ///< CPU: read the clock at every stage change
  bool counting_ = false;                          ///< count launches per stage
  std::chrono::steady_clock::time_point stage_start_;
#if SIM_CUDA
  bool capturing_ = false;
  cudaStream_t stream_ = nullptr;  ///< stream in capture
  StageBeginCallback began_;       ///< callback of the capture; may be null
  std::size_t stage_nodes_ = 0;    ///< graph nodes at the start of the stage
  std::size_t nodes_in_capture() const;
#endif
};

}  // namespace collidoscope
