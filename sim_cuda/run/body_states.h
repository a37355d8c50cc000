#pragma once
// State of all bodies on the host, as exchanged with a World. Plain data.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// State of all bodies in double; bit-exact. Quantities that are not stored are q = 1, w = 0. In float,
/// angular velocities of bodies with unequal moments have more digits than a float (dynamics/wide_spin.h).
struct BodyStates {
  std::vector<Vector3d> position, velocity, angular_velocity;
  std::vector<Quaterniond> orientation;
};

/// New id of each body, or `no_body` if it was removed. Ascending.
using BodyIdMap = std::vector<std::uint32_t>;
inline constexpr std::uint32_t no_body = 0xffffffffu;

}  // namespace collidoscope
