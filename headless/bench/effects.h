#pragma once
// `bench effects` checks that an effect which is off adds no launch and no buffer, and measures what one that
// is on costs. It runs one scene three times for each effect: without anything that calls for the effect;
// with what calls for it, but with the effect left out by a list; with the effect. The second run must have
// the launches, the buffers, the bytes and the hash of the first. The third must have another hash; with
// `guards`, which decide no state, the same hash and other launches. The runs take turns of a few steps, so
// that a ratio of times compares neighbouring turns. All three test the same branches, so the ratios do not
// show what a branch costs.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Exit status 1 where a run with the effect off differs from the run without it, or a run with the effect on
/// does not. Throws InputError for a scene that calls for more than gravity or has no generator, and
/// MachineError.
int bench_effects(const CommandLine& line);

}  // namespace collidoscope
