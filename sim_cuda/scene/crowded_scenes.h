#pragma once
// Scenes for comparing broad phases where bodies are not alike or not evenly spread: what the variants of the
// Box Collider do not show. Numbers come from Philox, and no libm is used, so they are the same everywhere.
//
// - mixed: half of the bodies have a radius of 1 m and fill 30 % of the box; the others, 1,000 times smaller,
//   lie in one corner of it, where they fill 30 % of a cube.
// - log_normal: radii exp(z) m, z normal with mean 0 and variance 1; they fill 30 % of the box.
// - clusters: radii of 1 m, in 16 cubes that are 30 % full and 1,000 times smaller than the box.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// mixed, log_normal, clusters.
std::span<const std::string> crowded_scene_names();
/// Names that --variants takes: the variants of the Box Collider, and these.
std::vector<std::string> compared_scenes();

/// `like` with other bodies and another box: without generators and joints. `name`: one of these.
Scene crowded_scene(const std::string& name, std::int64_t bodies, std::uint64_t seed, const Scene& like);

}  // namespace collidoscope
