#pragma once
// The `capture` command: steps a world to each state asked for and writes a picture of it.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/world.h"
#include "viewer/render/draw_options.h"
#include "viewer/render/frame_layers.h"
#include "viewer/render/interop/display_path.h"

namespace collidoscope {

struct CaptureRequest {
  /// Ascending; state k is the state after k steps. Empty: where the run stands, and 30 and 60 steps on.
  std::vector<std::int64_t> states;
  FrameLayers layers{.spheres = true};
  int width = 1280, height = 800;  ///< pixels, 16 to 16384
  std::string out = "captures";    ///< the folder; made if it is not there
  bool timings = false;            ///< stage times as measured; else drawn as a dash, so that pictures repeat
  DisplayPath display_path = DisplayPath::automatic;
  DrawWish draw;
};

/// Each throws InputError with lines that begin with `where`.
std::vector<std::int64_t> parse_states(const std::string& text, const std::string& where = "--states");
/// WIDTHxHEIGHT, each 16 to 16384.
void parse_size(const std::string& text, CaptureRequest& request, const std::string& where = "--size");

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
