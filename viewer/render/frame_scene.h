#pragma once
// Data of a scene for drawing that do not change between states. Plain data, made once.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim_cuda/scene/initial_bodies.h"
#include "viewer/render/orbit_camera.h"

namespace collidoscope {

struct FrameScene {
  /// A range of bodies in the published array with the same mesh. Precondition: Publisher::publish() stores
  /// body i at index i, and meshes never change.
  struct Run {
    std::uint32_t mesh = 0;  ///< 0: spheres; k: meshes[k - 1]
    std::int64_t first = 0, count = 0;
  };

  double size = 1;            ///< m, diagonal of the bounds without added bodies (Scene::added)
  Bounds bounds;              ///< bounds of the box, else of the bodies at state 0 and their landing points
  std::optional<Box> box;     ///< box whose edges are drawn as walls
  std::vector<Plane> planes;  ///< obstacle planes
  std::vector<BoxObstacle> boxes;  ///< obstacle boxes
  double floor = 0;                ///< m, height of the grid
  double grid_spacing = 10;        ///< m, a round number
  double body_size = 1;            ///< m, mean radius
  double largest_radius = 0;       ///< m, radius of the largest body
  double total_mass = 0;           ///< kg, total mass
  std::int64_t body_count = 0;
  std::vector<Mesh> meshes;
  std::vector<Run> runs;
};

FrameScene frame_scene(const Scene& scene, const InitialBodies& bodies);

/// FrameScene::bounds for these body positions. Non-finite positions are ignored.
Bounds scene_bounds(const Scene& scene, const std::optional<Box>& box, std::span<const Vector3d> position,
                    std::span<const double> radius);

}  // namespace collidoscope
