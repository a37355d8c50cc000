#pragma once
// The ball that the key B throws into a scene, from the eye along the line of sight.

#include <optional>
#include <span>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// What a ball must not overlap where it starts.
struct ProjectileSpace {
  std::optional<Box> walls;
  std::span<const Plane> planes;
  std::span<const Vector3d> position;  ///< m, of the bodies that there are
  std::span<const double> radius;      ///< m, of the same
};

/// A sphere of the material "default": its radius is 1/50 of the scene's `size` (m), and it crosses a third
/// of that in a second. It starts at the first place on its way at which it fits between walls, above planes
/// and beside bodies; none: there is no such place.
std::optional<Body> make_projectile(const Vector3d& eye, const Vector3d& direction, double size,
                                    const ProjectileSpace& room);

}  // namespace collidoscope
