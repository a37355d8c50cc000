#pragma once
// The `bench` command: a table of suites, each a file of this folder. A suite measures, prints a table on
// stdout, and writes JSON where --json asks for it.

#include <span>

#include "headless/cli/command_line.h"

namespace collidoscope {

std::span<const Suite> suites();

/// The suite that the line names.
int bench_command(const CommandLine& line);

}  // namespace collidoscope
