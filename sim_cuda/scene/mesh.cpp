#include "sim_cuda/scene/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/import/file_format.h"
#include "sim_cuda/import/surface.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/mass_properties.h"
#include "sim_cuda/scene/text_file.h"

namespace collidoscope {
namespace {

constexpr std::size_t max_file_size = std::size_t{64} << 20;  // bytes; checking takes 13 times as much memory
constexpr std::size_t max_faults = 100;

/// A directed edge of a face.
struct Edge {
  std::uint32_t from, to;
  std::uint32_t place;  ///< of the face, as in Surface
  std::uint32_t low() const { return std::min(from, to); }
  std::uint32_t high() const { return std::max(from, to); }
};

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  /// Throws all faults.
  Surface read() {
    while (!text_.empty() && faults_.size() < max_faults) {
      const std::size_t end = std::min(text_.find('\n'), text_.size());
      line_ = text_.substr(0, end);
      text_.remove_prefix(std::min(end + 1, text_.size()));
      ++line_number_;
      if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
      read_line();
    }
    if (!faults_.empty()) throw InputError(std::move(faults_));
    return std::move(surface_);
  }

 private:
  void fault_here(std::string_view word, const std::string& what) {
    if (faults_.size() == max_faults) return;
    const std::size_t column = static_cast<std::size_t>(word.data() - line_.data()) + 1;
    faults_.push_back(fmt::format("{}:{}:{}: {}", file_, line_number_, column, what));
  }

  /// The next word of the line. Empty at its end or at the start of a comment.
  static std::string_view next_word(std::string_view& rest) {
    const std::size_t start = std::min(rest.find_first_not_of(" \t"), rest.size());
    rest.remove_prefix(start);
    const std::size_t size = rest.starts_with('#') ? 0 : std::min(rest.find_first_of(" \t"), rest.size());
    const std::string_view word = rest.substr(0, size);
    rest.remove_prefix(size);
    return word;
  }

  void read_line() {
    std::string_view rest = line_;
    const std::string_view keyword = next_word(rest);
    if (keyword == "v") {
      read_vertex(keyword, rest);
    } else if (keyword == "f") {
      read_face(keyword, rest);
    } else {
      for (const std::string_view passed : {"", "vt", "vn", "o", "g", "s", "usemtl", "mtllib"}) {
        if (keyword == passed) return;
      }
      fault_here(keyword, fmt::format("unsupported keyword \"{}\"; a mesh consists of `v x y z` and `f i j k "
                                      "...` (vt, vn, o, g, s, usemtl and mtllib are ignored)",
                                      printable(keyword)));
    }
  }

  static std::string printable(std::string_view word) {
    std::string text(word.substr(0, 40));
    for (char& c : text) {
      if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
    }
    return text;
  }

  void read_vertex(std::string_view keyword, std::string_view rest) {
    double value[7];
    int count = 0;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      if (count == 7) return fault_here(word, "a vertex has at most 7 numbers: x y z, w = 1 and a colour");
      const std::string_view digits = word.substr(word.starts_with('+') ? 1 : 0);
      double& x = value[count++];
      const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
      if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(x)) {
        return fault_here(
            word, fmt::format("\"{}\" is not a number; expected `v x y z`, in metres", printable(word)));
      }
      if (std::abs(x) > limits::max_coordinate) {
        return fault_here(word, fmt::format("{} is out of range; a coordinate must be in [-1e9, 1e9] m", x));
      }
    }
    if (count < 3) return fault_here(keyword, fmt::format("{} numbers; expected `v x y z`", count));
    if (count != 6 && count > 3 && value[3] != 1) {
      return fault_here(keyword, "a vertex with a weight other than 1; give only x y z");
    }
    surface_.vertices.emplace_back(value[0], value[1], value[2]);
    if (surface_.vertices.size() > (std::size_t{1} << 30)) fault_here(keyword, "more than 2^30 vertices");
  }

  /// The vertex index, from 0, of a face corner `v`, `v/vt`, `v//vn` or `v/vt/vn`. A corner may refer to a
  /// later vertex.
  std::optional<std::uint32_t> corner(std::string_view word) {
    long long index[3] = {0, 0, 0};
    int part = 0;
    const char* at = word.data();
    const char* const end = word.data() + word.size();
    while (true) {
      const bool may_be_empty = part == 1 && at < end && *at == '/';
      if (!may_be_empty) {
        const auto [stop, error] = std::from_chars(at, end, index[part]);
        if (error != std::errc{}) return std::nullopt;
        at = stop;
      }
      if (at == end) break;
      if (*at != '/' || ++part == 3) return std::nullopt;
      ++at;
    }
    const long long absolute =
        index[0] > 0 ? index[0] - 1 : static_cast<long long>(surface_.vertices.size()) + index[0];
    if (index[0] == 0 || absolute < 0 || absolute >= (1LL << 30)) return std::nullopt;
    return static_cast<std::uint32_t>(absolute);
  }

  void read_face(std::string_view keyword, std::string_view rest) {
    Surface::Polygon polygon{static_cast<std::uint32_t>(surface_.corners.size()), 0, line_number_};
    constexpr std::uint32_t few = 64;        // corners; up to this number a linear search is used
    std::unordered_set<std::uint32_t> seen;  // used for more corners
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const std::optional<std::uint32_t> index = corner(word);
      if (!index) {
        return fault_here(word,
                          fmt::format("\"{}\" is not a vertex index; a corner is v, v/vt, v//vn or v/vt/vn, "
                                      "counted from 1, or from -1 backwards ({} vertices so far)",
                                      printable(word), surface_.vertices.size()));
      }
      const auto first = surface_.corners.begin() + polygon.first;
      if (polygon.count == few) seen.insert(first, surface_.corners.end());
      if (polygon.count < few ? std::find(first, surface_.corners.end(), *index) != surface_.corners.end()
                              : !seen.insert(*index).second) {
        return fault_here(
            word, fmt::format("vertex {} appears twice in one face; list each vertex once", *index + 1));
      }
      surface_.corners.push_back(*index);
      ++polygon.count;
    }
    if (polygon.count < 3) {
      return fault_here(keyword,
                        fmt::format("a face with {} corners; expected at least three", polygon.count));
    }
    surface_.polygons.push_back(polygon);
  }

  std::string_view text_, line_;
  const std::string& file_;
  std::uint32_t line_number_ = 0;
  Surface surface_;
  std::vector<std::string> faults_;
};

/// Checks that a surface can be a solid.
class SurfaceCheck {
 public:
  SurfaceCheck(const Surface& surface, const std::string& file) : surface_(surface), file_(file) {}

  /// Throws all faults.
  void run() {
    if (surface_.corners.empty()) faults_.push_back(file_ + ": there are no faces, expected a closed mesh");
    if (faults_.empty()) check_indices();
    if (faults_.empty()) check_closed();
    if (!faults_.empty()) throw InputError(std::move(faults_));
  }

 private:
  void fault(std::uint32_t place, const std::string& what) {
    if (faults_.size() < max_faults)
      faults_.push_back(fmt::format("{}: {}", place_text(surface_, file_, place), what));
  }

  void check_indices() {
    for (const Surface::Polygon& polygon : surface_.polygons) {
      for (std::uint32_t i = 0; i < polygon.count; ++i) {
        const std::uint32_t index = surface_.corners[polygon.first + i];
        if (index < surface_.vertices.size()) continue;
        if (faults_.size() == max_faults) return;
        fault(polygon.place, fmt::format("the face uses vertex {}, but the number of vertices is {}",
                                         index + 1, surface_.vertices.size()));
      }
    }
  }

  /// Checks that the surface is closed: every edge belongs to two faces, in opposite directions.
  void check_closed() {
    std::vector<Edge> edges;
    edges.reserve(surface_.corners.size());
    for (const Surface::Polygon& polygon : surface_.polygons) {
      const std::uint32_t* corner = surface_.corners.data() + polygon.first;
      for (std::uint32_t i = 0; i < polygon.count; ++i) {
        edges.push_back({corner[i], corner[i + 1 < polygon.count ? i + 1 : 0], polygon.place});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      if (a.low() != b.low()) return a.low() < b.low();
      if (a.high() != b.high()) return a.high() < b.high();
      return a.place < b.place;
    });
    // Keeps the first faults by line, then by this order, up to the limit of reported faults.
    std::map<std::pair<std::uint32_t, std::size_t>, std::string> found;
    const auto find = [&](std::size_t i, const std::string& what) {
      found.emplace(std::pair(edges[i].place, i), fmt::format("the edge from vertex {} to {} {}",
                                                              edges[i].from + 1, edges[i].to + 1, what));
      if (found.size() > max_faults) found.erase(std::prev(found.end()));
    };
    for (std::size_t i = 0; i < edges.size();) {
      std::size_t end = i + 1;
      while (end < edges.size() && edges[end].low() == edges[i].low() &&
             edges[end].high() == edges[i].high()) {
        ++end;
      }
      const bool told = found.size() < max_faults || edges[i].place < std::prev(found.end())->first.first;
      if (!told) {
        // not reported: the limit is reached
      } else if (end - i == 1) {
        find(i,
             "belongs only to this face, so the surface is open; close it (vertices at the same position "
             "must be merged)");
      } else if (end - i > 2) {
        find(i, fmt::format("belongs to {} faces; in a closed surface it must belong to two", end - i));
      } else if (edges[i].from == edges[i + 1].from) {
        find(i, fmt::format("has the same direction in the face of {}; reverse one of the faces",
                            place_name(edges[i + 1].place)));
      }
      i = end;
    }
    for (const auto& [place, what] : found) fault(place.first, what);
  }

  std::string place_name(std::uint32_t place) const {
    return fmt::format("{} {}", surface_.places_are_lines ? "line" : "facet", place);
  }

  const Surface& surface_;
  const std::string& file_;
  std::vector<std::string> faults_;
};

/// Splits polygons into fans of triangles.
std::vector<std::array<std::uint32_t, 3>> triangles_of(const Surface& surface) {
  std::vector<std::array<std::uint32_t, 3>> faces;
  faces.reserve(surface.corners.size() - 2 * surface.polygons.size());
  for (const Surface::Polygon& polygon : surface.polygons) {
    const std::uint32_t* const corner = surface.corners.data() + polygon.first;
    for (std::uint32_t i = 2; i < polygon.count; ++i) faces.push_back({corner[0], corner[i - 1], corner[i]});
  }
  return faces;
}

Surface read_surface(const std::string& text, const std::string& file) {
  switch (format_of_start(text, text.size())) {
    case FileFormat::stl:
      return read_stl_surface(text, file);
    case FileFormat::ply:
      return read_ply_surface(text, file);
    default:
      return ObjReader(text, file).read();
  }
}

}  // namespace

Mesh parse_mesh(const std::string& text, const std::string& file, const std::string& name) {
  Mesh mesh;
  mesh.name = name;
  with_allocation_context("reading a mesh", [&] {
    Surface surface = read_surface(text, file);
    SurfaceCheck(surface, file).run();
    mesh.faces = triangles_of(surface);
    mesh.vertices = std::move(surface.vertices);
  });

  const MassProperties solid = mass_properties(mesh.vertices, mesh.faces);
  if (solid.volume < 0) {
    throw InputError(file + ": the faces are clockwise seen from outside; reverse all faces");
  }
  const Vector3d moments = solid.inertia.diagonal();
  if (!(solid.volume > 0) || !(moments.minCoeff() > 0)) {
    throw InputError(file + ": the surface encloses no volume; a body needs a positive volume");
  }
  const PrincipalAxes principal = principal_axes(solid.inertia);
  if (!(principal.moments.minCoeff() > 0)) {
    throw InputError(
        file +
        ": the surface intersects itself, and a moment of inertia is not positive; remove the intersections");
  }
  mesh.volume = solid.volume;
  mesh.center = solid.center;
  mesh.axes = principal.axes;
  mesh.inertia_per_density = principal.moments;

  std::vector<char> used(mesh.vertices.size(), 0);
  for (const auto& face : mesh.faces) {
    for (const std::uint32_t vertex : face) used[vertex] = 1;
  }
  const Matrix3d to_principal = mesh.axes.toRotationMatrix().transpose();
  double farthest = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.vertices[i] = to_principal * (mesh.vertices[i] - mesh.center);
    if (used[i]) farthest = std::max(farthest, mesh.vertices[i].dot(mesh.vertices[i]));
  }
  mesh.bounding_radius = std::sqrt(farthest);
  if (mesh.bounding_radius < limits::min_radius || mesh.bounding_radius > limits::max_radius) {
    throw InputError(
        fmt::format("{}: the mesh's bounding sphere has a radius of {:.3g} m; it must be in [{}, {}] m", file,
                    mesh.bounding_radius, limits::min_radius, limits::max_radius));
  }
  return mesh;
}

std::string mesh_file(const Scene& scene, const std::string& name) {
  return (std::filesystem::path(scene.directory) / name).lexically_normal().string();
}

std::string read_mesh_text(const std::string& file) {
  return read_text_file(file, max_file_size, "a closed mesh (OBJ, STL or PLY)");
}

Mesh read_mesh(const std::string& file, const std::string& name) {
  return parse_mesh(read_mesh_text(file), file, name);
}

}  // namespace collidoscope
