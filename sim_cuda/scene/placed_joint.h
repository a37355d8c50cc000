#pragma once
// Joints as solvers need them: nothing left unset, in the frames that bodies are simulated in.

#include <cstdint>
#include <vector>

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

struct PlacedJoint {
  static constexpr std::uint32_t world = 0xffffffffu;

  JointKind kind;
  std::uint32_t a, b;            ///< ids; b: or `world`
  Vector3d anchor_a, anchor_b;   ///< m, along principal axes from the centre; a place, where b is the world
  double low, high;              ///< m, of a distance; high: or infinity. Of a spring, both are its length
  Vector3d axis;                 ///< of a hinge, unit, along a's principal axes
  Quaterniond start;             ///< turns b's principal axes into a's, at the start
  bool limited;                  ///< a hinge that has limits
  double low_angle, high_angle;  ///< radians, -pi to pi
  double frequency, damping_ratio;
  bool collide;
};

/// Of a valid scene, in its order. `bodies` are the scene's own.
std::vector<PlacedJoint> place_joints(const Scene& scene, const InitialBodies& bodies);

/// Whether a joint turns what it holds: a hinge does, and an anchor beside the centre of a body.
bool joints_turn_bodies(const Scene& scene);

}  // namespace collidoscope
