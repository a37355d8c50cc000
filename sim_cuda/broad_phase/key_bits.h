#pragma once
// How long Morton keys must be in a scene. Short keys take a third of the time to sort; but bodies with equal
// keys are neighbours in the order without being neighbours in space, and queries then visit all of them.
// Decided once, on the host, from the radii, the box and the positions at the start. It decides how fast a
// tree is, never what it finds.

#include <vector>

#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

/// 24, 30 or 63.
/// - The shortest that tells as many cells apart as there are bodies: 30 where keys are sorted by counting,
///   which takes the same time for 24; else 24 up to 2^24 bodies.
/// - Longer where that many bits leave bodies at `position` (of all `bodies`, m) in crowds with equal keys.
/// - 63 where crowds would make a counting sort slow: where they are now, or where the smaller bodies (a
///   tenth to a half of all) would form one if they gathered, at the density of random close packing. And 63
///   where there is no box, since one body that flies away stretches the cells of all others.
int automatic_key_bits(const InitialBodies& bodies, const std::vector<Vector3d>& position,
                       SortMethod sort = SortMethod::automatic);
inline int automatic_key_bits(const InitialBodies& bodies) {
  return automatic_key_bits(bodies, bodies.position);
}

}  // namespace collidoscope
