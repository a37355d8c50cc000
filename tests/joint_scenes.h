#pragma once
// A space without bodies for tests of joints, and joints between two bodies or to the world.

#include "tests/scenes.h"

namespace collidoscope {

/// Restitution 0, solver soft_step, 60 steps per second.
inline Scene joint_space(double gravity, Precision precision = Precision::f64) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = precision;
  scene.physics.gravity = Vector3d(0, 0, -gravity);
  scene.physics.time_step = 1.0 / 60;
  scene.materials[0].restitution = 0;
  return scene;
}

inline Joint joint_to_world(JointKind kind, std::int64_t body, const Vector3d& place) {
  Joint joint;
  joint.kind = kind;
  joint.a = body;
  joint.anchor_b = place;
  return joint;
}

inline Joint joint_between(JointKind kind, std::int64_t a, std::int64_t b) {
  Joint joint;
  joint.kind = kind;
  joint.a = a;
  joint.b = b;
  return joint;
}

}  // namespace collidoscope
