#pragma once
// The suite `bench scaling`: growth with N of each method's time from positions to the ordered list of pairs,
// measured at many N and fitted (growth.h). Files are rewritten after every row.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError and MachineError. The files contain the rows measured before.
int bench_scaling(const CommandLine& line);

}  // namespace collidoscope
