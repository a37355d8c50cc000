#pragma once
// Automatic choice of the Morton key length for a scene. Short keys take a third of the sorting time. But
// bodies with equal keys are adjacent in the order without being close in space, and queries visit all of
// them. Chosen once, on the host, from the radii, the box and the initial positions. The choice affects the
// speed of a tree, not the pairs found.

#include <vector>

#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

/// Returns 24, 30 or 63.
/// - The shortest length with at least as many distinct cells as bodies. 30 if keys are sorted by counting,
///   which takes the same time for 24; else 24 up to 2^24 bodies.
/// - A longer one if many bodies at `position` (all bodies, m) would share their key.
/// - 63 if crowded cells would make a counting sort slow. The cells are crowded now, or would be if the
///   smaller bodies (a tenth to a half of all) gathered at the density of random close packing.
/// - 63 without a box, because one escaping body enlarges the cells of all others.
int automatic_key_bits(const InitialBodies& bodies, const std::vector<Vector3d>& position,
                       SortMethod sort = SortMethod::automatic);
inline int automatic_key_bits(const InitialBodies& bodies) {
  return automatic_key_bits(bodies, bodies.position);
}

}  // namespace collidoscope
