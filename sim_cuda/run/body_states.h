#pragma once
// Bodies on the host, as a World gives and takes them. Plain data.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// The state of all bodies on the host, widened to double; bit-exact. Arrays that are not stored are filled
/// in (q = 1, w = 0).
struct BodyStates {
  std::vector<Vector3d> position, velocity, angular_velocity;
  std::vector<Quaterniond> orientation;
};

/// What became of bodies: the new id of each, or `no_body`. Ascending.
using BodyIdMap = std::vector<std::uint32_t>;
inline constexpr std::uint32_t no_body = 0xffffffffu;

}  // namespace collidoscope
