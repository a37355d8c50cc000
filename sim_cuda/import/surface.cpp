#include "sim_cuda/import/surface.h"

#include <fmt/format.h>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/file_format.h"

namespace collidoscope {
namespace {

void check_indices(const Surface& surface, const std::string& file) {
  constexpr std::size_t most_faults = 100;
  std::vector<std::string> faults;
  for (const Surface::Polygon& polygon : surface.polygons)
    for (std::uint32_t k = 0; k < polygon.count && faults.size() < most_faults; ++k) {
      const std::uint32_t index = surface.corners[polygon.first + k];
      if (index >= surface.vertices.size())
        faults.push_back(fmt::format("{}: the face uses vertex {}, but the number of vertices is {}",
                                     place_text(surface, file, polygon.place), index + 1,
                                     surface.vertices.size()));
    }
  if (!faults.empty()) throw InputError(faults);
}

Surface read_any_surface(std::string_view bytes, const std::string& file) {
  switch (format_of_start(bytes, bytes.size())) {
    case FileFormat::stl:
      return read_stl_surface(bytes, file);
    case FileFormat::ply:
      return read_ply_surface(bytes, file);
    default:
      return read_obj_surface(bytes, file);
  }
}

}  // namespace

std::string place_text(const Surface& surface, const std::string& file, std::uint32_t place) {
  return surface.places_are_lines ? fmt::format("{}:{}:1", file, place)
                                  : fmt::format("{}: facet {}", file, place);
}

Surface read_surface(std::string_view bytes, const std::string& file) {
  Surface surface = read_any_surface(bytes, file);
  check_indices(surface, file);
  return surface;
}

std::vector<std::array<std::uint32_t, 3>> triangles_of(const Surface& surface) {
  std::vector<std::array<std::uint32_t, 3>> faces;
  faces.reserve(surface.corners.size() - 2 * surface.polygons.size());
  for (const Surface::Polygon& polygon : surface.polygons) {
    const std::uint32_t* const corner = surface.corners.data() + polygon.first;
    for (std::uint32_t k = 2; k < polygon.count; ++k) faces.push_back({corner[0], corner[k - 1], corner[k]});
  }
  return faces;
}

}  // namespace collidoscope
