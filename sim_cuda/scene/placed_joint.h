#pragma once
// Joints in the form that solvers need: all values set, in the principal axes of the bodies. SI units.

#include <cstdint>
#include <vector>

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

struct PlacedJoint {
  static constexpr std::uint32_t world = 0xffffffffu;

  JointKind kind;
  std::uint32_t a, b;           ///< ids of the bodies; b may be `world`
  Vector3d anchor_a, anchor_b;  ///< m, along principal axes from the centre; a world position if b is the
                                ///< world
  double low, high;   ///< m; distance joint: range, high may be infinity; spring: both are the rest length
  Vector3d axis;      ///< hinge axis, unit length, along a's principal axes
  Quaterniond start;  ///< initial rotation from b's principal axes to a's
  bool limited;       ///< true: a hinge with angle limits
  double low_angle, high_angle;  ///< rad, -pi to pi
  double frequency, damping_ratio;
  bool collide;
};

/// Places the joints of a valid scene, in the scene's order. `bodies` must be the initial bodies of the
/// scene.
std::vector<PlacedJoint> place_joints(const Scene& scene, const InitialBodies& bodies);

/// True if a joint can apply a torque: a hinge, or an anchor off the centre of mass.
bool joints_turn_bodies(const Scene& scene);

}  // namespace collidoscope
