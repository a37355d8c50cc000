#pragma once
// The `bvh` command: how good each method's hierarchy is at the state after --steps steps.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Returns the exit status. Throws InputError and MachineError, and has written nothing then.
int bvh_command(const CommandLine& line);

}  // namespace collidoscope
