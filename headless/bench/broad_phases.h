#pragma once
// `bench broad-phases`: how long each method takes from positions to the ordered list of pairs, over methods,
// variants and numbers of bodies, at the initial state of the Box Collider. Files are rewritten after every
// row, so that a run that is cut short keeps what it has.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError and MachineError; rows that were measured before are in the files.
int bench_broad_phases(const CommandLine& line);

}  // namespace collidoscope
