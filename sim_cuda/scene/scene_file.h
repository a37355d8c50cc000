#pragma once
// Scene files: JSON with comments, `"format": "collidoscope-scene", "version": 1`. README.md of this
// folder lists every field with unit, range and default.

#include <string>
#include <vector>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// One thing wrong with a scene: where (a path such as `bodies[3].radius`), and what, and what would be
/// right.
struct Fault {
  std::string path;  ///< as it is: a material's name may hold anything
  std::string message;
};

/// `path: message` in one line, whatever the path holds.
std::string line_of(const Fault& fault);

/// Every fault of the values in `scene`, in the order of the file format; empty if it can be simulated. Paths
/// are those of the file format. What needs the bodies themselves (mesh files, masses that follow from
/// densities, room for `apart`) is checked by initial_bodies().
std::vector<Fault> validate(const Scene& scene);
/// The scene itself. Throws InputError with a line for each fault.
const Scene& valid(const Scene& scene);

/// Reads (at most 64 MiB, 2^23 values, 2^20 in a list of bodies or joints), and validates. Throws InputError
/// with one line per fault, `file:line:column: what, and what would be right`.
Scene read_scene(const std::string& file);
/// The same from text; `name` stands where the file would.
Scene parse_scene(std::string text, const std::string& name, const std::string& directory = ".");

/// The scene as a file. For a valid scene parse_scene(write_scene(s)) equals s, bit for bit (but for `file`
/// and `directory`, which are not written).
std::string write_scene(const Scene& scene);

/// A body as an object of JSON. Its material is one of the scene's.
std::string write_body(const Body& body, const Scene& scene);

/// Whether a quaternion or normal counts as being of unit length. Reading normalises only what does not.
bool is_unit(double squared_length);

}  // namespace collidoscope
