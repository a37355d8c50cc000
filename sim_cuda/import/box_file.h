#pragma once
// Axis-aligned boxes of foreign programs, to inspect broad phases on them.

#include <string>
#include <vector>

#include "sim_cuda/core/aabb.h"
#include "sim_cuda/import/body_table.h"

namespace collidoscope {

/// Reads the boxes of the triangles of a mesh (OBJ, STL or PLY, also open), or boxes from a NumPy file: an
/// array of shape (n, 6), a row for each box: min x, y, z, max x, y, z; or of shape (n, 2, 3). Broad phases
/// use single precision. Other numbers are rounded outwards, so that no overlap is lost. Throws InputError
/// with a line for each faulty row, at most 20.
std::vector<Aabb> read_boxes(const std::string& file);
/// The same as bodies: spheres within the boxes, at their centres.
BodyTable read_box_table(const std::string& file);
/// Whether a NumPy file has the shape of boxes: (n, 6) with min <= max in each row, or (n, 2, 3).
bool is_box_file(const std::string& file);
/// Whether read_boxes() can read it: a mesh, or an array of boxes.
bool is_box_source(const std::string& file);

}  // namespace collidoscope
