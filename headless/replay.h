#pragma once
// The command `replay`: verifies a recording.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Returns 0 if every recorded state is reached again, else 1. Throws MachineError if the recording has
/// another physics version.
int replay_command(const CommandLine& line);

}  // namespace collidoscope
