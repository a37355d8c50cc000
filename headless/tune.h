#pragma once
// The command `tune`: a map of step times over launch shapes, and the fastest shape.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Returns 1 if a shape leads to another state hash, else 0.
int tune_command(const CommandLine& line);

}  // namespace collidoscope
