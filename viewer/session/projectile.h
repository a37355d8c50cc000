#pragma once
// The ball added with the key B, launched from the eye along the line of sight.

#include <optional>
#include <span>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Objects that the ball must not overlap at its start.
struct ProjectileSpace {
  std::optional<Box> walls;
  std::span<const Plane> planes;
  std::span<const Vector3d> position;  ///< m, positions of the bodies
  std::span<const double> radius;      ///< m, radii of the bodies
};

/// A sphere of the material "default". Its radius is 1/50 of the scene's `size` (m), and its speed is a third
/// of `size` per second. It starts at the first free position between walls, planes and bodies; unset: there
/// is none.
std::optional<Body> make_projectile(const Vector3d& eye, const Vector3d& direction, double size,
                                    const ProjectileSpace& room);

}  // namespace collidoscope
