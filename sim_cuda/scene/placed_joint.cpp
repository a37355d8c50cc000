#include "sim_cuda/scene/placed_joint.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace collidoscope {
namespace {

/// Initial frame of a body: transforms own axes, as in scene files, to world axes.
struct Frame {
  Vector3d center{0, 0, 0};
  Quaterniond own{1, 0, 0, 0};        ///< own axes to world axes
  Quaterniond principal{1, 0, 0, 0};  ///< principal axes to own axes
};

Frame frame_of(const InitialBodies& bodies, std::int64_t id) {
  const auto body = static_cast<std::size_t>(id);
  Frame frame{bodies.position[body], {1, 0, 0, 0}, {1, 0, 0, 0}};
  if (!bodies.orientation.empty()) frame.own = bodies.orientation[body];
  if (!bodies.mesh.empty() && bodies.mesh[body] != 0) {
    frame.principal = bodies.meshes[bodies.mesh[body] - 1].axes;
    frame.own = frame.own * frame.principal.conjugate();
  }
  return frame;
}

PlacedJoint place(const Joint& joint, const InitialBodies& bodies) {
  const Frame a = frame_of(bodies, joint.a), b = joint.b ? frame_of(bodies, *joint.b) : Frame{};
  const Vector3d at_a = a.center + a.own * joint.anchor_a;
  const bool in_common = joint.kind == JointKind::ball || joint.kind == JointKind::hinge;
  const Vector3d own_b = joint.anchor_b ? *joint.anchor_b
                         : in_common    ? Vector3d(b.own.conjugate() * (at_a - b.center))
                                        : Vector3d(0, 0, 0);
  const Vector3d apart = b.center + b.own * own_b - at_a;
  const double placed = std::sqrt(apart.dot(apart));
  const bool open = !joint.length && (joint.min_length || joint.max_length);
  const double radian = std::numbers::pi / 180;

  PlacedJoint placed_joint{};
  placed_joint.kind = joint.kind;
  placed_joint.a = static_cast<std::uint32_t>(joint.a);
  placed_joint.b = joint.b ? static_cast<std::uint32_t>(*joint.b) : PlacedJoint::world;
  placed_joint.anchor_a = a.principal.conjugate() * joint.anchor_a;
  placed_joint.anchor_b = b.principal.conjugate() * own_b;
  placed_joint.low = open ? joint.min_length.value_or(0) : joint.length.value_or(placed);
  placed_joint.high = open ? joint.max_length.value_or(std::numeric_limits<double>::infinity())
                           : joint.length.value_or(placed);
  placed_joint.axis = a.principal.conjugate() * joint.axis;
  placed_joint.start = (a.own * a.principal).conjugate() * (b.own * b.principal);
  placed_joint.limited = joint.limits.has_value();
  if (joint.limits) {
    placed_joint.low_angle = (*joint.limits)[0] * radian;
    placed_joint.high_angle = (*joint.limits)[1] * radian;
  }
  placed_joint.frequency = joint.frequency;
  placed_joint.damping_ratio = joint.damping_ratio;
  placed_joint.collide = joint.collide;
  return placed_joint;
}

}  // namespace

std::vector<PlacedJoint> place_joints(const Scene& scene, const InitialBodies& bodies) {
  std::vector<PlacedJoint> placed;
  placed.reserve(scene.joints.size());
  for (const Joint& joint : scene.joints) placed.push_back(place(joint, bodies));
  return placed;
}

bool joints_turn_bodies(const Scene& scene) {
  for (const Joint& joint : scene.joints) {
    const bool held_aside =
        joint.b && (joint.anchor_b ? !joint.anchor_b->isZero(0) : joint.kind == JointKind::ball);
    if (joint.kind == JointKind::hinge || !joint.anchor_a.isZero(0) || held_aside) return true;
  }
  return false;
}

}  // namespace collidoscope
