#pragma once
// Surfaces of mesh files: vertices and polygons, before they are checked.

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

/// Reads STL, text or binary. Vertices at the same place are merged. Throws InputError.
Surface read_stl_surface(std::string_view bytes, const std::string& file);
/// Reads vertices and faces of a PLY file, text or binary. Throws InputError.
Surface read_ply_surface(std::string_view bytes, const std::string& file);

/// "file:3:1" or "file: facet 3".
std::string place_text(const Surface& surface, const std::string& file, std::uint32_t place);

}  // namespace collidoscope
