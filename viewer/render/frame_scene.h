#pragma once
// What pictures of a scene need to know and what does not change from state to state. Plain data, made once.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim_cuda/scene/initial_bodies.h"
#include "viewer/render/orbit_camera.h"

namespace collidoscope {

struct FrameScene {
  /// Bodies that follow each other in the published array and are drawn alike. (Publisher::publish() writes
  /// body i to place i, and the mesh of a body never changes.)
  struct Run {
    std::uint32_t mesh = 0;  ///< 0: spheres; k: meshes[k - 1]
    std::int64_t first = 0, count = 0;
  };

  double size = 1;  ///< m, diagonal of the bounds without bodies that were added (Scene::added)
  Bounds bounds;  ///< of the box, else of the bodies at state 0 and of where they meet the planes below them
  std::optional<Box> box;          ///< whose edges are the walls
  std::vector<Plane> planes;       ///< the obstacles
  std::vector<BoxObstacle> boxes;  ///< as well
  double floor = 0;                ///< m, height of the grid
  double grid_spacing = 10;        ///< m, a round number
  double body_size = 1;            ///< m, mean radius
  double largest_radius = 0;       ///< m
  double total_mass = 0;           ///< kg
  std::int64_t body_count = 0;
  std::vector<Mesh> meshes;
  std::vector<Run> runs;
};

FrameScene frame_scene(const Scene& scene, const InitialBodies& bodies);

/// FrameScene::bounds with the bodies at these places; those that are no numbers are left out.
Bounds scene_bounds(const Scene& scene, const std::optional<Box>& box, std::span<const Vector3d> position,
                    std::span<const double> radius);

}  // namespace collidoscope
