#pragma once
// Broad-phase plug-ins that flags name, for both programs.

#include "headless/cli/options.h"

namespace collidoscope {

/// Tests the plug-ins of --broad-phase and --methods in separate processes and loads them; their paths are
/// replaced by names. Prints a line on stderr for each, and one for each test with wrong pairs: such a
/// plug-in is loaded, and all its pairs are compared. Throws InputError for a file that is not a plug-in, or
/// that crashes or hangs.
void load_plugins(Options& options);

}  // namespace collidoscope
