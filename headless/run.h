#pragma once
// The commands that step a scene. Each returns the exit status of a run that came to its end, and throws
// InputError or MachineError otherwise; nothing is written then.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// `run`: steps, then writes the files asked for, then reports on stdout.
int run_command(const CommandLine& line);

/// `capture`: pictures of the states asked for, then what each stage cost.
int capture_command(const CommandLine& line);

}  // namespace collidoscope
