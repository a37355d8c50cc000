#pragma once
// The options of the `capture` command. Plain data, and the function that reads its flags.

#include <cstdint>
#include <string>
#include <vector>

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
  DrawRequest draw;
  std::int64_t draw_gpu = -1;  ///< CUDA device that draws; -1: the one that simulates

  int drawing_gpu(int simulating) const { return draw_gpu >= 0 ? static_cast<int>(draw_gpu) : simulating; }
};

/// Each throws InputError with lines that begin with `where`.
std::vector<std::int64_t> parse_states(const std::string& text, const std::string& where = "--states");
/// WIDTHxHEIGHT, each 16 to 16384.
void parse_size(const std::string& text, CaptureRequest& request, const std::string& where = "--size");

}  // namespace collidoscope
