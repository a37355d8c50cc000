#pragma once
// Seeded random scenes for property tests. They are valid and use every feature of the scene format.

#include <cstdint>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

enum class Values {
  ordinary,  ///< everyday sizes, masses and speeds
  extreme    ///< the full range of each field, including both limits
};

/// Returns the same scene for the same seed on every machine. A scene has at most about 80 bodies.
Scene any_scene(std::uint32_t seed, Values values);

}  // namespace collidoscope
