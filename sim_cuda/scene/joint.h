#pragma once
// A joint between two bodies as given in a scene file. Plain data in SI units.
// Sliders, motors and breakable joints are not implemented yet.

#include <array>
#include <cstdint>
#include <optional>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// distance: rod or rope between two points. spring: spring and damper between two points. ball: one common
/// point. hinge: one common axis.
enum class JointKind { distance, spring, ball, hinge };

struct Joint {
  JointKind kind = JointKind::distance;
  std::int64_t a = 0;             ///< id of the first body
  std::optional<std::int64_t> b;  ///< id of the second body; unset: the world, which is fixed
  Vector3d anchor_a{0, 0, 0};  ///< m, from a's centre of mass, in a's own axes (the file's axes for a mesh)
  /// Second anchor in metres: in b's own axes from b's centre of mass, or a world position if b is unset.
  /// Default for a ball or hinge: the initial position of anchor_a. Default for a distance or spring: b's
  /// centre; required if b is the world.
  std::optional<Vector3d> anchor_b;
  Vector3d axis{0, 0, 1};  ///< hinge axis, unit length, in a's own axes; normalised when read

  // Distance joint: `length` (rod), or a range with at most one open end (rope, strut). Spring: `length` is
  // the rest length. All unset: the initial distance.
  std::optional<double> length, min_length, max_length;  ///< m

  /// Angle limits of a hinge relative to the initial pose. The angle is that of b against a,
  /// counter-clockwise about the axis seen from its tip. Unset: no limits.
  std::optional<std::array<double, 2>> limits;  ///< degrees, -180 <= limits[0] <= limits[1] <= 180

  // Spring parameters. They refer to the effective mass of the two anchors.
  double frequency = 1;      ///< Hz, undamped, > 0
  double damping_ratio = 0;  ///< 1: critical damping

  bool collide = false;  ///< true: a and b still have contacts
};

}  // namespace collidoscope
