#pragma once
// `bench scaling`: how the time of each method, from positions to the ordered list of pairs, grows with N:
// measured at many N, and fitted (growth.h). Files are rewritten after every row.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError and MachineError; rows that were measured before are in the files.
int bench_scaling(const CommandLine& line);

}  // namespace collidoscope
