#include "sim_cuda/scene/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <utility>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
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

/// Checks that a surface can be a solid.
class SurfaceCheck {
 public:
  SurfaceCheck(const Surface& surface, const std::string& file) : surface_(surface), file_(file) {}

  /// Throws all faults.
  void run() {
    if (surface_.corners.empty()) faults_.push_back(file_ + ": there are no faces, expected a closed mesh");
    if (faults_.empty()) check_closed();
    if (!faults_.empty()) throw InputError(std::move(faults_));
  }

 private:
  void fault(std::uint32_t place, const std::string& what) {
    if (faults_.size() < max_faults)
      faults_.push_back(fmt::format("{}: {}", place_text(surface_, file_, place), what));
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
