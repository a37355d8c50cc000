#pragma once
// Wavefront OBJ files, read strictly: `v` and `f` count (indices from 1, or negative from the end; v, v/vt,
// v//vn and v/vt/vn; polygons are fanned into triangles from their first corner); vt, vn, o, g, s, usemtl,
// mtllib and comments are passed over; anything else is a fault. The surface must be closed and its faces
// counter-clockwise seen from outside, for it is a solid that has a mass. Faces that cut through each other
// are not looked for.

#include <string>

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

/// Reads `file`. Throws InputError, `file:line:column: what, and what would be right`, with every fault.
/// `name` is kept as Mesh::name.
Mesh read_mesh(const std::string& file, const std::string& name);

/// The path of a mesh that a body of the scene names.
std::string mesh_file(const Scene& scene, const std::string& name);
/// The bytes of a mesh file. Throws InputError if it cannot be read.
std::string read_mesh_text(const std::string& file);

/// A mesh from its text.
Mesh parse_mesh(const std::string& text, const std::string& file, const std::string& name);

}  // namespace collidoscope
