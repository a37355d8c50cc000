#pragma once
// Scenes for comparing broad phases on bodies of different sizes or uneven density. The variants of the Box
// Collider do not cover these cases.
// Random numbers come from Philox and no libm function is used, so the scenes are the same on every platform.
//
// - mixed: half of the bodies have a radius of 1 m and fill 30 % of the box. The other half is 1,000 times
//   smaller and fills 30 % of a cube in one corner.
// - log_normal: radii exp(z) m, z normal with mean 0 and variance 1; they fill 30 % of the box.
// - clusters: radii of 1 m in 16 cubes. Each cube is 30 % full and 1,000 times smaller than the box.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// "mixed", "log_normal", "clusters".
std::span<const std::string> crowded_scene_names();
/// Names accepted by --variants: the variants of the Box Collider and the crowded scenes.
std::vector<std::string> compared_scenes();

/// Copies `like` and replaces its bodies and its box. The copy has no generators and no joints. `name` must
/// be one of crowded_scene_names().
Scene crowded_scene(const std::string& name, std::int64_t bodies, std::uint64_t seed, const Scene& like);

}  // namespace collidoscope
