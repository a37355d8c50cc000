#pragma once
// The ball that the key B throws into a scene, from the eye along the line of sight.

#include <optional>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// A sphere of the material "default": its radius is 1/50 of the scene's `size` (m), and it crosses a third
/// of that in a second. Where there are walls it starts at the first place on its way at which it fits
/// between them; none: it would never come there.
std::optional<Body> thrown_ball(const Vector3d& eye, const Vector3d& direction, double size,
                                const std::optional<Box>& walls);

}  // namespace collidoscope
