#pragma once
// `accuracy [SCENE]`: what accuracy costs in a scene, by a study (sim_cuda/accuracy/study.h); without a
// scene, the analytic suite. Files are written anew each second and whole; Ctrl-C ends it with all that is
// known, and the same command goes on from the file of --json.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// The exit status: 1 where no setting's error is within --tolerance. After Ctrl-C it does not return: the
/// program ends by that signal. Throws InputError or MachineError.
int accuracy_command(const CommandLine& line);

}  // namespace collidoscope
