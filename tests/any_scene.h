#pragma once
// Scenes that nobody would think of: seeded, valid, of everything that a scene file may hold.

#include <cstdint>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

enum class Values {
  ordinary,  ///< of things one could hold, or drive
  extreme    ///< from one end of each range to the other, and the ends themselves
};

/// The same for the same seed, on every machine. Up to some eighty bodies.
Scene any_scene(std::uint32_t seed, Values values);

}  // namespace collidoscope
