#pragma once
// The `bench` command: a table of suites, each a file of this folder. A suite measures, prints a table on
// stdout, and writes JSON where --json asks for it.

#include <span>
#include <string_view>

#include "headless/cli/command_line.h"

namespace collidoscope {

struct Suite {
  const char* name;
  const char* help;
  std::string_view flags;  ///< those it reads of the ones that bench has and run has not
  /// The suite's operands are a scene, or nothing; flags are those of `bench`. Returns the exit status;
  /// throws InputError or MachineError, and has written nothing then.
  int (*run)(const CommandLine& line);
};
std::span<const Suite> suites();

/// The suite that the line names.
int bench_command(const CommandLine& line);

}  // namespace collidoscope
