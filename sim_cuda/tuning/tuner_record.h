#pragma once
// The finished measurements of a LaunchTuner, in order. A search depends on nothing else, so another process
// can repeat it to the same point and go on. Plain data.

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "sim_cuda/tuning/launch_search.h"

namespace collidoscope {

/// How long the measurements of a cell took, ms.
struct CellTimes {
  double search = 0;                                    ///< the decision to measure it
  double setup = 0;                                     ///< change of shape, and the first steps
  double benchmark = 0;                                 ///< timed steps of cell and reference
  double check = 0;                                     ///< state hashes
  std::chrono::system_clock::time_point measured_at{};  ///< end of the last one
};

struct TunerRecord {
  struct StagePair {
    std::string name;
    double ms = 0, reference_ms = 0;
    double occupancy = 0;  ///< of the cell, 0 to 1
  };
  struct Pair {
    double ms = 0, reference_ms = 0;  ///< of a step: of the cell and of the reference
    std::vector<StagePair> stages;
  };
  struct Task {
    std::size_t cell = 0;
    bool hurried = false;  ///< LaunchSearch::hurry() was called before
    LaunchCell::State state = LaunchCell::State::measured;
    std::string reason;  ///< why it is infeasible or wrong
    std::vector<Pair> pairs;
    CellTimes times;
  };
  double spent = 0;  ///< s
  std::vector<Task> tasks;
};

}  // namespace collidoscope
