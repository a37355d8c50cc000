#pragma once
// The command `accuracy [SCENE]`: an accuracy study of a scene (sim_cuda/accuracy/study.h), or the analytic
// suite without a scene.
// Output files are replaced atomically once per second. After Ctrl-C they contain all results so far, and the
// same command resumes from the --json file.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Returns the exit status: 1 if no setting has an error within --tolerance. After Ctrl-C it does not return:
/// the program ends by that signal. Throws InputError or MachineError.
int accuracy_command(const CommandLine& line);

}  // namespace collidoscope
