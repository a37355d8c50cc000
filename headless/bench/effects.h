#pragma once
// The suite `bench effects`: checks that a disabled effect adds no launch and no buffer, and measures the
// cost of an enabled effect.
// Each effect has three runs of one scene: (1) the scene does not require the effect; (2) it requires the
// effect, but the effect is excluded by a list; (3) the effect is on.
// Run 2 must have the same launches, buffers, bytes and hash as run 1. Run 3 must have a different hash. With
// `guards`, which do not affect the state, it must have the same hash and different launches.
// The runs alternate every few steps, so that each ratio compares adjacent measurements. All three test the
// same branches, so the ratios do not include the cost of a branch.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Returns exit status 1 if run 2 differs from run 1, or if run 3 does not. Throws MachineError, and
/// InputError for a scene that requires more than gravity or has no generator.
int bench_effects(const CommandLine& line);

}  // namespace collidoscope
