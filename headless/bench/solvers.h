#pragma once
// The suite `bench solvers`: the same bodies from the same state, simulated by this project's solvers and, if
// available, by Bullet 2. Runs on the CPU with one thread each (--cpu-threads changes it for this project's
// solvers).
// Reports the cost of a step, and the final overlap and energy. The contestants alternate, so that each ratio
// compares adjacent measurements.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws MachineError, and InputError for a scene with features other than spheres, planes and friction,
/// which the Bullet baseline does not support.
int bench_solvers(const CommandLine& line);

}  // namespace collidoscope
