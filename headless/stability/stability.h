#pragma once
// `stability [CASE...]`: the hard cases (sim_cuda/stability/hard_case.h), each with every solver in both
// precisions; with --plant the faults that must fail their criteria; with --readme the table of what other
// runs wrote.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// The exit status: 1 where something failed that is no declared limit, or a declared limit holds, or a
/// injected fault shows nowhere. After Ctrl-C it does not return: what is known is told, and the program ends
/// by that signal. Throws InputError or MachineError.
int stability_command(const CommandLine& line);

}  // namespace collidoscope
