#pragma once
// How a stage was launched, in words. Free functions over plain data.

#include <string>
#include <vector>

#include "sim_cuda/run/history.h"

namespace collidoscope {

/// Of one stage, in a few lines: what was launched, what runs at once, and what keeps more from it.
std::string launch_text(const History::Stage& stage);

/// What "auto" chose over all stages of the newest step. No lines where nothing is known yet.
struct LaunchRange {
  std::string blocks, threads;     ///< "16" or "1 to 1,056"; on the CPU, whose lanes have neither, empty
  std::vector<std::string> lines;  ///< why
};
LaunchRange launch_range(const History& history);

}  // namespace collidoscope
