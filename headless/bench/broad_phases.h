#pragma once
// The suite `bench broad-phases`: time from positions to the ordered list of pairs, for each method, variant
// and number of bodies, at the initial state of the Box Collider. Files are rewritten after every row, so an
// interrupted run keeps its results.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError and MachineError. The files contain the rows measured before.
int bench_broad_phases(const CommandLine& line);

}  // namespace collidoscope
