#pragma once
// Times of steps and stages. Plain data, read by panels, JSON export and tests.

#include <string>
#include <vector>

#include "sim_cuda/core/stage_launch.h"

namespace collidoscope {

/// Cost of one stage over the measured steps.
struct StageTime {
  std::string name;  ///< the same in the profiler panel, NVTX, graphs and exports
  double median_ms = 0, p95_ms = 0, last_ms = 0;
  int launches = 0;             ///< kernels per step (CPU: parallel loops)
  bool library_launch = false;  ///< partly launched by a library that ignores (B, T)
  StageLaunch launch{};         ///< launch of the largest kernel that obeys (B, T)
  int samples = 0;              ///< timed steps; 0: the times are unknown
};

/// Step times come from uninstrumented steps, stage times from instrumented steps. The two are never mixed.
struct RunTimes {
  double step_median_ms = 0, step_p95_ms = 0;  ///< 0 before the first timed step
  double step_last_ms = 0;                     ///< of the newest timed step
  int steps_timed = 0;
  std::vector<StageTime> stages;  ///< in pipeline order
};

/// Times of the broad phase of one state, ms.
struct BroadPhaseTimes {
  std::vector<float> whole;  ///< per repeat, uninstrumented
  struct Stage {
    std::string name;
    std::vector<float> ms;  ///< per repeat
    int launches = 0;
    bool library_launch = false;
  };
  std::vector<Stage> stages;  ///< from separate, instrumented repeats
};

}  // namespace collidoscope
