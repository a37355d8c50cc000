#pragma once
// Strict reader of meshes: Wavefront OBJ, STL and PLY, detected by content (import/surface.h reads the last
// two). OBJ:
// - `v` and `f` are read. Indices count from 1, or backwards if negative; corners are v, v/vt, v//vn or
//   v/vt/vn. Polygons are split into a triangle fan from their first corner.
// - vt, vn, o, g, s, usemtl, mtllib and comments are ignored. Any other line is a fault.
// - The surface must be closed, with faces counter-clockwise seen from outside, because the mesh is a solid
//   with a mass. Self-intersection is not checked.

#include <string>

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

/// Reads `file`. `name` becomes Mesh::name. Throws InputError with all faults, one per line as
/// `file:line:column: message`.
Mesh read_mesh(const std::string& file, const std::string& name);

/// The file path of a mesh that a body of the scene refers to.
std::string mesh_file(const Scene& scene, const std::string& name);
/// The bytes of a mesh file. Throws InputError if it cannot be read.
std::string read_mesh_text(const std::string& file);

/// Parses the text of a mesh file. Throws InputError like read_mesh().
Mesh parse_mesh(const std::string& text, const std::string& file, const std::string& name);

}  // namespace collidoscope
