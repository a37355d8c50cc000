#pragma once
// `bench timeline`: how long it takes to reach an earlier state of a run, and what keeping the timeline
// costs.

#include "headless/cli/command_line.h"

namespace collidoscope {

int bench_timeline(const CommandLine& line);

}  // namespace collidoscope
