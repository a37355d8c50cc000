#pragma once
// Texts about the launch of a stage. Free functions over plain data.

#include <string>
#include <vector>

#include "sim_cuda/run/history.h"

namespace collidoscope {

/// The launch of one stage in a few lines: launched blocks and items, resident blocks, and the limiter.
std::string launch_text(const History::Stage& stage);

/// Range of the shapes that "auto" chose for the stages of the newest step. Empty if no launch is recorded.
struct LaunchRange {
  std::string blocks, threads;     ///< "16" or "1 to 1,056"; empty on the CPU
  std::vector<std::string> lines;  ///< chunks or occupancy, and limiters
};
LaunchRange launch_range(const History& history);

}  // namespace collidoscope
