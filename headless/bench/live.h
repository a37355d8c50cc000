#pragma once
// `bench live`: how much a drawn window slows down the simulation, and how often it is drawn meanwhile.

#include "headless/cli/command_line.h"

namespace collidoscope {

int bench_live(const CommandLine& line);

}  // namespace collidoscope
