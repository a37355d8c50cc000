#pragma once
// Which stage is in progress, and what the StageClock records of it: times on the CPU, launches on both. A
// GPU measures times with events in a captured graph (step_graph.h).

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
  /// Called when the work of a stage has been enqueued completely, with the substep in which it began.
  using StageCallback = std::function<void(const char* stage, int substep)>;

  StageClock& clock() { return clock_; }

  /// Ends the stage in progress and begins `name`, unless that is the stage in progress. `library_launch`:
  /// (B, T) does not apply to the stage.
  void begin(const char* name, bool library_launch);
  void end();
  /// Stages that begin from now on belong to this substep (from 0).
  void begin_substep(int substep) { substep_ = substep; }
  /// Calls `work`, and `ended` after each stage that begins in it. `ended` is not called for the stages that
  /// it begins itself. Starts with substep 0.
  void run_with_stage_callback(const StageCallback& ended, const std::function<void()>& work);

  // On the CPU a step runs immediately. begin_step() clears the launch counts and shapes of the step before.
  void begin_step(bool timed);
  void end_step();
  void cancel_step();  ///< where Cancelled was thrown in the middle of a step

  bool counting() const { return counting_; }
  void count_launches(int launches);
  /// CPU: one more parallel loop of the stage in progress, if there is a stage and launches are counted.
  void count_loop(const StageLaunch& loop);

#if SIM_CUDA
  // GPU: one step, captured as a graph.

  /// Called at the start of each stage, with its index in the clock.
  using StageBeginCallback = std::function<void(std::size_t entry)>;
  /// `stream` is being captured. With `began` the step is instrumented; null: it is a plain one, and the
  /// launches of each stage are counted.
  void begin_capture(cudaStream_t stream, StageBeginCallback began);
  void end_capture();
  void drop_capture();  ///< where the capture failed: also forgets the stage in progress
  /// A kernel of the stage in progress. Ignored outside of a capture.
  void note_launch(const StageLaunch& launch);
#endif

 private:
  void close();

  StageClock clock_;
  const char* stage_ = nullptr;  ///< the stage in progress, or null
  std::size_t stage_entry_ = 0;
  int substep_ = 0, stage_substep_ = 0;
  const StageCallback* stage_callback_ = nullptr;  ///< null: no watch, or its function is running
  bool timing_ = false;                            ///< CPU: read the clock at every change of stage
  bool counting_ = false;                          ///< count launches per stage
  std::chrono::steady_clock::time_point stage_start_;
#if SIM_CUDA
  bool capturing_ = false;
  cudaStream_t stream_ = nullptr;  ///< while capturing
  StageBeginCallback began_;       ///< while capturing; may be null
  std::size_t stage_nodes_ = 0;    ///< nodes of the graph at the start of the stage
  std::size_t nodes_in_capture() const;
#endif
};

}  // namespace collidoscope
