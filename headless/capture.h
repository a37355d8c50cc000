#pragma once
// The `capture` command: advances a world to the requested states and writes a picture of each.

#include <cstdint>
#include <string>
#include <vector>

#include "headless/cli/capture_request.h"
#include "sim_cuda/import/body_table.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// A scene's name for use in a file name: lower-case letters, digits, '-' and '_'; not empty.
std::string file_stem(const std::string& scene);

/// The requested states of a run that starts at state `first`.
std::vector<std::int64_t> states_to_draw(const CaptureRequest& request, std::int64_t first);
std::string picture_file(const CaptureRequest& request, const Scene& scene, std::int64_t state);

/// Writes OUT/<scene>_<state>.png for each state; each file is written atomically. Prints one line per
/// picture on stdout, and the renderer and display path on stderr.
/// `frames`: if not empty, state k has the bodies of frame k, and nothing is simulated.
/// Returns 0, or 1 if a guard paused the run (with a line on stderr). Throws InputError and MachineError.
int run_capture(const CaptureRequest& request, World& world, const std::vector<BodyTable>& frames = {});

}  // namespace collidoscope
