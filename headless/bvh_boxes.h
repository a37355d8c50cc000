#pragma once
// `bvh --boxes`: broad phases on boxes from a file, without bodies.

#include "headless/cli/options.h"

namespace collidoscope {

/// Returns the exit status: 1 if a method finds other pairs than the reference. Throws InputError and
/// MachineError.
int bvh_of_boxes(const Options& options);

}  // namespace collidoscope
