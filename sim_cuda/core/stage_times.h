#pragma once
// How long steps and stages took: plain data, read by panels, JSON and tests alike.

#include <string>
#include <vector>

#include "sim_cuda/core/stage_launch.h"

namespace collidoscope {

/// One stage's cost over the steps measured so far.
struct StageTime {
  std::string name;  ///< the same in profiler, NVTX, graphs and exports
  double median_ms = 0, p95_ms = 0, last_ms = 0;
  int launches = 0;             ///< kernels per step (CPU: parallel loops)
  bool library_launch = false;  ///< part of it runs in a library that ignores (B, T)
  StageLaunch launch{};         ///< what the rest of it was launched as
  int samples = 0;              ///< steps that were timed; 0: the times are not known
};

/// Times of the whole step come from plain steps, times of stages from instrumented ones; they are never
/// mixed.
struct RunTimes {
  double step_median_ms = 0, step_p95_ms = 0;  ///< 0 while no plain step was timed
  double step_last_ms = 0;                     ///< the newest of them
  int steps_timed = 0;
  std::vector<StageTime> stages;  ///< in the order of the pipeline
};

/// How long the broad phase of one state takes, ms.
struct BroadPhaseTimes {
  std::vector<float> whole;  ///< each repeat, nothing measured within
  struct Stage {
    std::string name;
    std::vector<float> ms;  ///< each repeat
    int launches = 0;
    bool library_launch = false;
  };
  std::vector<Stage> stages;  ///< of other repeats, with a time taken after each stage
};

}  // namespace collidoscope
