#pragma once
// The command `stability [CASE...]`: runs the hard cases (sim_cuda/stability/hard_case.h) with every solver
// in both precisions. --inject-faults runs the injected faults, each of which must fail its assertion.
// --write-table writes the table from the files of other runs.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Returns the exit status. It is 1 if a test fails that is not an expected failure, if an expected failure
/// passes, or if an injected fault is not detected.
/// After Ctrl-C it does not return: it prints the results so far, and the program ends by that signal. Throws
/// InputError or MachineError.
int stability_command(const CommandLine& line);

}  // namespace collidoscope
