#pragma once
// Surfaces of mesh files: vertices and polygons, before they are checked.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

struct Surface {
  struct Polygon {
    std::uint32_t first, count;  ///< its corners
    std::uint32_t place;         ///< line in the file, or number of the facet from 1
  };
  std::vector<Vector3d> vertices;      ///< m
  std::vector<std::uint32_t> corners;  ///< vertex indices
  std::vector<Polygon> polygons;
  bool places_are_lines = true;  ///< else facets
};

/// Reads OBJ, STL or PLY, detected by content. All corners are vertices; whether the surface is closed is not
/// checked. Throws InputError.
Surface read_surface(std::string_view bytes, const std::string& file);
/// Polygons as fans of triangles.
std::vector<std::array<std::uint32_t, 3>> triangles_of(const Surface& surface);

/// Strict reader of Wavefront OBJ: scene/mesh.h says what it reads.
Surface read_obj_surface(std::string_view text, const std::string& file);
/// Text or binary. Vertices at the same place are merged; facets without area are left out.
Surface read_stl_surface(std::string_view bytes, const std::string& file);
/// Vertices and faces; text or binary.
Surface read_ply_surface(std::string_view bytes, const std::string& file);

/// "file:3:1" or "file: facet 3".
std::string place_text(const Surface& surface, const std::string& file, std::uint32_t place);

}  // namespace collidoscope
