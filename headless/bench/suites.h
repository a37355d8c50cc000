#pragma once
// The `bench` command and its table of suites, one file of this folder each. A suite measures, prints a table
// on stdout, and writes JSON if --json is given.

#include <span>

#include "headless/cli/command_line.h"

namespace collidoscope {

std::span<const Suite> suites();

/// Runs the suite that the command line names. Returns the exit status.
int bench_command(const CommandLine& line);

}  // namespace collidoscope
