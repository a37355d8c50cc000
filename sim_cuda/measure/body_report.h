#pragma once
// What World tells of its tree and of one body. Plain data, SI units.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// The boxes of the hierarchy, level by level from the root (level 0).
struct TreeLevels {
  struct Box {
    float min[3], max[3];
  };
  std::vector<std::vector<Box>> levels;
};

/// Everything about one body, as the paper's Dynamics (Baraff 1997) has it, with its contacts and its place
/// in the tree.
struct BodyReport {
  std::uint32_t id = 0;
  double mass = 0, radius = 0;      ///< kg, 0 of a body that no force moves; m
  Vector3d X{0, 0, 0};              ///< m, position
  Quaterniond q{1, 0, 0, 0};        ///< R as a quaternion: principal axes to world
  Vector3d v{0, 0, 0}, w{0, 0, 0};  ///< m/s, rad/s
  Vector3d P{0, 0, 0}, L{0, 0, 0};  ///< kg m/s, kg m^2/s: momentum, angular momentum about the centre
  Matrix3d inverse_inertia = Matrix3d::Zero();  ///< 1/(kg m^2), world axes
  Vector3d F{0, 0, 0}, T{0, 0, 0};              ///< N, N m: what forwarding will apply (gravity)
  struct Contact {
    std::uint32_t other;
    Vector3d normal;     ///< unit, from this body to the other
    double penetration;  ///< m
    double impulse;      ///< N s, normal, of the last step; 0 where it is not recorded
  };
  std::vector<Contact> contacts;   ///< that touch now, by the other's id; the first 1,024
  std::int64_t contact_count = 0;  ///< all of them
  std::vector<TreeLevels::Box>
      path;                ///< the boxes that hold it, from its leaf to the root; empty without a tree
  std::int64_t leaf = -1;  ///< its place in the tree's order
};

}  // namespace collidoscope
