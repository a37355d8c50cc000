#pragma once
// The command `validate`: tests of a broad-phase plug-in.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Prints a table of the tests. Returns the exit status: 1 if a test failed.
int validate_command(const CommandLine& line);

}  // namespace collidoscope
