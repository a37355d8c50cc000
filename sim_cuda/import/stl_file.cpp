#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/import/frame_text.h"
#include "sim_cuda/import/surface.h"
#include "sim_cuda/import/text_rows.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

constexpr std::size_t stl_header = 84, stl_facet = 50;

struct PlaceHash {
  std::size_t operator()(const std::array<std::uint64_t, 3>& bits) const {
    return mix64(bits[0] ^ mix64(bits[1] ^ mix64(bits[2])));
  }
};

/// Merges vertices at the same place.
class MergedVertices {
 public:
  explicit MergedVertices(Surface& surface) : surface_(surface) {}
  std::uint32_t index_of(const Vector3d& x) {
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value); };
    const auto [entry, is_new] = indices_.try_emplace({bits(x.x()), bits(x.y()), bits(x.z())},
                                                      static_cast<std::uint32_t>(surface_.vertices.size()));
    if (is_new) surface_.vertices.push_back(x);
    return entry->second;
  }

 private:
  Surface& surface_;
  std::unordered_map<std::array<std::uint64_t, 3>, std::uint32_t, PlaceHash> indices_;
};

/// Adds a facet. Facets without area, with two equal corners, are left out.
void add_facet(MergedVertices& vertices, const Vector3d (&x)[3], std::uint32_t place, Surface& surface) {
  std::uint32_t corner[3];
  for (int k = 0; k < 3; ++k) corner[k] = vertices.index_of(x[k]);
  if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) return;
  surface.polygons.push_back({static_cast<std::uint32_t>(surface.corners.size()), 3, place});
  surface.corners.insert(surface.corners.end(), corner, corner + 3);
}

bool is_in_range(const Vector3d& x) {
  return x.cwiseAbs().maxCoeff() <= limits::max_coordinate && x.allFinite();
}

Surface read_binary_stl(std::string_view bytes, const std::string& file) {
  Surface surface;
  surface.places_are_lines = false;
  MergedVertices vertices(surface);
  const std::size_t facets = (bytes.size() - stl_header) / stl_facet;
  for (std::size_t k = 0; k < facets; ++k) {
    Vector3d x[3];
    for (std::size_t corner = 0; corner < 3; ++corner) {
      float value[3];
      std::memcpy(value, bytes.data() + stl_header + k * stl_facet + 12 * (corner + 1), sizeof value);
      x[corner] = Vector3d(value[0], value[1], value[2]);
      if (!is_in_range(x[corner]))
        throw InputError(fmt::format("{}: facet {}: a corner out of range, expected coordinates up to {:g} m",
                                     file, k + 1, limits::max_coordinate));
    }
    add_facet(vertices, x, static_cast<std::uint32_t>(k + 1), surface);
  }
  return surface;
}

Surface read_text_stl(std::string_view text, const std::string& file) {
  Surface surface;
  MergedVertices vertices(surface);
  LineReader lines(file, text);
  Vector3d x[3];
  int corners = 0;
  bool in_loop = false;
  for (lines.skip_empty(); !lines.at_end(); lines.skip_empty()) {
    const std::vector<std::string_view> words = fields_of(lines.next("endsolid"), ' ');
    if (words[0] == "outer") {
      in_loop = true;
      corners = 0;
    } else if (words[0] == "vertex") {
      double value[3] = {};
      bool good = in_loop && corners < 3 && words.size() == 4;
      for (std::size_t k = 0; good && k < 3; ++k) good = is_number(words[k + 1], value[k]);
      if (good) x[corners] = Vector3d(value[0], value[1], value[2]);
      if (!good || !is_in_range(x[corners]))
        lines.fail("damaged vertex", "three lines `vertex x y z` between outer loop and endloop");
      ++corners;
    } else if (words[0] == "endloop") {
      if (corners != 3) lines.fail(fmt::format("a facet of {} corners", corners), "3");
      add_facet(vertices, x, static_cast<std::uint32_t>(lines.line() - 1), surface);
      in_loop = false;
    } else if (words[0] != "solid" && words[0] != "facet" && words[0] != "endfacet" &&
               words[0] != "endsolid") {
      lines.fail("unknown line", "solid, facet, outer loop, vertex, endloop, endfacet or endsolid");
    }
  }
  return surface;
}

}  // namespace

Surface read_stl_surface(std::string_view bytes, const std::string& file) {
  if (bytes.size() >= stl_header) {
    std::uint32_t facets = 0;
    std::memcpy(&facets, bytes.data() + 80, sizeof facets);
    if (bytes.size() == stl_header + stl_facet * static_cast<std::size_t>(facets))
      return read_binary_stl(bytes, file);
  }
  return read_text_stl(bytes, file);
}

}  // namespace collidoscope
