#pragma once
// What holds two bodies together, as scene files say it: plain data in SI units. Sliders, motors and joints
// that break are to come: a kind or a field more.

#include <array>
#include <cstdint>
#include <optional>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// A rod or rope between two points; a spring and damper between them; one point in common; one axis in
/// common.
enum class JointKind { distance, spring, ball, hinge };

struct Joint {
  JointKind kind = JointKind::distance;
  std::int64_t a = 0;             ///< id of a body
  std::optional<std::int64_t> b;  ///< id of another; unset: the world, which nothing moves
  Vector3d anchor_a{0, 0,
                    0};  ///< m, from a's centre of mass, in a's own axes (those of its file, for a mesh)
  /// The same of b; a place in the world, where that is b. Unset: for a ball or hinge, where anchor_a is at
  /// the start; for a distance or spring, b's centre: the world has none, so there it must be set.
  std::optional<Vector3d> anchor_b;
  Vector3d axis{0, 0, 1};  ///< of a hinge, unit length, in a's own axes; normalised on reading

  // Of a distance: `length` (a rod), or a range of which one end may be open (a rope, a strut). Of a spring:
  // `length`, at rest. Unset, all of them: as far apart as at the start.
  std::optional<double> length, min_length, max_length;  ///< m

  /// Of a hinge: from the pose at the start, counter-clockwise about the axis seen from its tip, b against a;
  /// unset: it turns freely.
  std::optional<std::array<double, 2>> limits;  ///< degrees, -180 <= limits[0] <= limits[1] <= 180

  // Of a spring. The mass that they speak of is what the two anchors have against each other.
  double frequency = 1;      ///< Hz, undamped, > 0
  double damping_ratio = 0;  ///< 1: just no overshoot

  bool collide = false;  ///< whether a and b still touch each other
};

}  // namespace collidoscope
