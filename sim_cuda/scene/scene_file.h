#pragma once
// Reading, validating and writing scene files: JSON with comments, `"format": "collidoscope-scene",
// "version": 1`. README.md of this folder lists every field with unit, range and default.

#include <string>
#include <vector>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// An invalid value of a scene: its path (such as `bodies[3].radius`) and a message with the expected value.
struct Fault {
  std::string path;  ///< unescaped: a material's name may contain any character
  std::string message;
};

/// `path: message` in one line. Control characters in the path are replaced.
std::string line_of(const Fault& fault);

/// All invalid values of `scene`, in the order of the file format. Empty if the scene can be simulated.
/// Paths are those of the file format. initial_bodies() checks values that depend on the bodies: mesh files,
/// masses computed from densities, room for `apart`.
std::vector<Fault> validate(const Scene& scene);
/// Returns the scene if it is valid. Otherwise throws InputError with one line per fault.
const Scene& valid(const Scene& scene);

/// Reads and validates a scene file of at most 64 MiB, 2^23 values and 2^20 entries per list.
/// Throws InputError with one line per fault: `file:line:column: message`.
Scene read_scene(const std::string& file);
/// Reads and validates a scene from text. `name` replaces the file name in messages.
Scene parse_scene(std::string text, const std::string& name, const std::string& directory = ".");

/// The scene as the text of a file. For a valid scene, parse_scene(write_scene(s)) equals s in every bit,
/// except for `file` and `directory`, which are not written.
std::string write_scene(const Scene& scene);

/// A body as a JSON object. Its material must be one of the scene's.
std::string write_body(const Body& body, const Scene& scene);

/// True if a quaternion or normal counts as normalised. The reader normalises all others.
bool is_unit(double squared_length);

}  // namespace collidoscope
