#pragma once
// `bench effects`: that an effect which is off costs nothing, and what one that is on costs. For each effect
// three runs of one scene: one that has never heard of it; one that calls for it, with the effect left out by
// a list; one with the effect. The second must have the launches, the buffers, the bytes and the hash of the
// first; the third must not, or the comparison proves nothing. They take turns, so that ratios of their times
// compare neighbours.
//
// With --effects-code FOLDER, the objects of the target `effects_code` (sim_cuda/effects_code.cmake), also:
// every kernel of a build without the effect is in the build with all of them byte for byte, with as many
// registers and parameters; what that has beyond is what the effect adds.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Exit status 1 where an effect that is off leaves a trace, or one that is on none. Throws InputError for a
/// scene that calls for more than gravity or has no generator, and MachineError.
int bench_effects(const CommandLine& line);

}  // namespace collidoscope
