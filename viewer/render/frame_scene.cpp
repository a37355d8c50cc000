#include "viewer/render/frame_scene.h"

#include <algorithm>
#include <cmath>

namespace collidoscope {
namespace {

// 1, 2 or 5 times a power of ten, near an eighth of the scene's width.
double round_spacing(double width) {
  const double rough = std::max(width, 1e-9) / 8;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (double step : {1.0, 2.0, 5.0})
    if (rough <= 1.5 * step * power) return step * power;
  return 10 * power;
}

Bounds bounds_of(std::span<const Vector3d> position, std::span<const double> radius) {
  Bounds bounds{Vector3d::Constant(1e300), Vector3d::Constant(-1e300)};
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (!position[i].allFinite()) continue;
    const Vector3d reach = Vector3d::Constant(radius[i]);
    bounds.min = bounds.min.cwiseMin(position[i] - reach);
    bounds.max = bounds.max.cwiseMax(position[i] + reach);
  }
  return bounds.min.x() <= bounds.max.x() ? bounds : Bounds{};
}

/// Height of the highest horizontal plane below the bodies.
std::optional<double> floor_of(const Scene& scene) {
  std::optional<double> floor;
  for (const Plane& plane : scene.obstacles)
    if (plane.normal.z() >= 0.999 * plane.normal.norm())
      floor = std::max(floor.value_or(plane.offset), plane.offset);
  return floor;
}

// Intersection of the ray from `from` along gravity with the nearest plane. Returns `from` if there is none.
Vector3d landing(const Scene& scene, const Vector3d& from) {
  if (!(scene.physics.gravity.norm() > 0)) return from;
  const Vector3d down = scene.physics.gravity.normalized();
  double fall = 1e300;
  for (const Plane& plane : scene.obstacles) {
    const double approach = -plane.normal.dot(down);
    if (approach > 1e-6) fall = std::min(fall, (plane.normal.dot(from) - plane.offset) / approach);
  }
  return fall > 0 && fall < 1e300 ? Vector3d(from + fall * down) : from;
}

}  // namespace

Bounds scene_bounds(const Scene& scene, const std::optional<Box>& box, std::span<const Vector3d> position,
                    std::span<const double> radius) {
  if (box) return {box->min, box->max};
  Bounds bounds = bounds_of(position, radius);
  // If an obstacle plane is a floor, the grid lies there.
  if (const std::optional<double> floor = floor_of(scene)) bounds.min.z() = std::min(bounds.min.z(), *floor);
  // On slopes, bodies fall out of the bounds of state 0. The bounds are extended to where the bodies land.
  Bounds lower = bounds;
  const auto reach = [&](const Vector3d& from) {
    const Vector3d place = landing(scene, from);
    lower.min = lower.min.cwiseMin(place);
    lower.max = lower.max.cwiseMax(place);
  };
  if (scene.obstacles.empty() || position.empty()) return lower;
  for (const Vector3d& each : position)
    if (each.allFinite()) reach(each);
  reach(bounds.center());
  return lower;
}

FrameScene frame_scene(const Scene& scene, const InitialBodies& bodies) {
  FrameScene result;
  result.box = bodies.box;
  result.planes = scene.obstacles;
  result.boxes = scene.boxes;
  const std::span<const Vector3d> position = bodies.position;
  const std::span<const double> radius = bodies.radius;
  result.bounds = scene_bounds(scene, bodies.box, position, radius);
  const std::size_t own = bodies.size() - std::min(bodies.size(), scene.extra_bodies.size());
  result.size = own > 0 ? scene_bounds(scene, bodies.box, position.first(own), radius.first(own)).diagonal()
                        : result.bounds.diagonal();
  result.floor =
      bodies.box ? bodies.box->min.z() : floor_of(scene).value_or(bounds_of(position, radius).min.z());
  const Vector3d width = result.bounds.max - result.bounds.min;
  result.grid_spacing = round_spacing(std::max(width.x(), width.y()));
  double sum = 0;
  for (const double r : radius) sum += r;
  if (bodies.size()) result.body_size = sum / static_cast<double>(bodies.size());
  if (bodies.size()) result.largest_radius = *std::ranges::max_element(bodies.radius);
  for (double mass : bodies.mass) result.total_mass += mass;
  result.body_count = static_cast<std::int64_t>(bodies.size());
  result.meshes = bodies.meshes;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::uint32_t mesh = bodies.mesh.empty() ? 0 : bodies.mesh[i];
    if (result.runs.empty() || result.runs.back().mesh != mesh)
      result.runs.push_back({mesh, static_cast<std::int64_t>(i), 0});
    ++result.runs.back().count;
  }
  return result;
}

}  // namespace collidoscope
