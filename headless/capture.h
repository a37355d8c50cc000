#pragma once
// The `capture` command: steps a world to each state asked for and writes a picture of it.

#include <cstdint>
#include <string>
#include <vector>

#include "headless/cli/capture_request.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// A scene's name as part of a file's: letters in lower case, digits, '-' and '_'; never empty.
std::string file_stem(const std::string& scene);

/// Of a run that starts at state `first`, as the request has it.
std::vector<std::int64_t> states_to_draw(const CaptureRequest& request, std::int64_t first);
std::string picture_file(const CaptureRequest& request, const Scene& scene, std::int64_t state);

/// Writes OUT/<scene>_<state>.png for each state, whole or not at all, and prints one line per picture on
/// stdout; says on stderr which renderer and display path drew them. Returns 0; 1 where a guard paused the
/// run, after a line on stderr. Throws InputError and MachineError.
int run_capture(const CaptureRequest& request, World& world);

}  // namespace collidoscope
