#pragma once
// The `bvh` command: quality of each method's hierarchy at the state after --steps steps.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Returns the exit status. Throws InputError and MachineError before any file is written.
int bvh_command(const CommandLine& line);

}  // namespace collidoscope
