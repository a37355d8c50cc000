#pragma once
// Scene files: JSON with comments, `"format": "collidoscope-scene", "version": 1`. The README's table lists
// every field with unit, range and default.

#include <string>
#include <vector>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// One thing wrong with a scene: where (a path such as `bodies[3].radius`), and what, and what would be
/// right.
struct Fault {
  std::string path;
  std::string message;
};

/// Every fault of the values in `scene`, in the order of the file format; empty if it can be simulated.
std::vector<Fault> validate(const Scene& scene);

/// Reads, and validates. Throws InputError with one line per fault, `file:line:column: what, and what would
/// be right`.
Scene read_scene(const std::string& file);
/// The same from text; `name` stands where the file would.
Scene parse_scene(const std::string& text, const std::string& name, const std::string& directory = ".");

/// The scene as a file: parse_scene(write_scene(s)) equals s, bit for bit.
std::string write_scene(const Scene& scene);

}  // namespace collidoscope
