#pragma once
// `bench solvers`: the same bodies from the same state, stepped by our solvers and, where libbullet-dev is,
// by Bullet 2, on the CPU and one thread each (ours on --cpu-threads, where that is given): what a step
// costs, and what overlap and energy are left at the end. Everybody takes turns, so that a ratio compares
// neighbours in time.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError for a scene with more than spheres, planes and friction, of which Bullet is told here,
/// and MachineError.
int bench_solvers(const CommandLine& line);

}  // namespace collidoscope
