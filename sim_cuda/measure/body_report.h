#pragma once
// Reports of World about its tree and about one body. Plain data, SI units.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Boxes of the tree by level; level 0 is the root.
struct TreeLevels {
  struct Box {
    float min[3], max[3];
  };
  std::vector<std::vector<Box>> levels;
};

/// All quantities of a body, named as in the paper's Dynamics (Baraff 1997), with its contacts and its
/// position in the tree.
struct BodyReport {
  std::uint32_t id = 0;
  double mass = 0, radius = 0;      ///< kg, 0 for static and kinematic bodies; m
  Vector3d X{0, 0, 0};              ///< position, m
  Quaterniond q{1, 0, 0, 0};        ///< rotation R from principal axes to world
  Vector3d v{0, 0, 0}, w{0, 0, 0};  ///< velocity, m/s; angular velocity, rad/s
  Vector3d P{0, 0, 0}, L{0, 0, 0};  ///< momentum, kg m/s; angular momentum about the centre, kg m^2/s
  Matrix3d inverse_inertia = Matrix3d::Zero();  ///< world axes, 1/(kg m^2)
  Vector3d F{0, 0, 0}, T{0, 0, 0};  ///< force, N, and torque, N m, that forwarding will apply (gravity)
  struct Contact {
    std::uint32_t other;
    Vector3d normal;     ///< unit, from this body to the other
    double penetration;  ///< m
    double impulse;      ///< normal impulse of the last step, N s; 0 if not recorded
  };
  std::vector<Contact> contacts;      ///< touching contacts by the other's id; the first 1,024
  std::int64_t contact_count = 0;     ///< number of all touching contacts
  std::vector<TreeLevels::Box> path;  ///< boxes from its leaf to the root; empty without a tree
  std::int64_t leaf = -1;             ///< index in the leaf order; -1 without a tree
};

}  // namespace collidoscope
