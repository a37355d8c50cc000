#pragma once
// The commands that step a scene. Each returns the exit status of a completed run. Otherwise each throws
// InputError or MachineError, and writes no file.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// `run`: makes the steps, writes the requested files, prints a report on stdout.
int run_command(const CommandLine& line);

/// `capture`: writes pictures of the requested states, then prints the cost of each stage.
int capture_command(CommandLine line);

}  // namespace collidoscope
