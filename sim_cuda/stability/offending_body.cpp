#include "sim_cuda/stability/offending_body.h"

#include <algorithm>
#include <set>
#include <utility>

namespace collidoscope {
namespace {

bool is_finite(const Vector3d& v) { return v.array().isFinite().all(); }

/// Deepest overlap so far in m, of two bodies or of a body and a wall, and its body.
struct Depth {
  double depth = 0;
  std::optional<std::uint32_t> body;
  void see(double other, std::uint32_t id) {
    if (other <= depth) return;
    depth = other;
    body = id;
  }
};

std::optional<std::uint32_t> deepest(World& world) {
  const BodyStates bodies = world.bodies();
  const InitialBodies& initial = world.initial();
  std::set<std::pair<std::int64_t, std::int64_t>> apart;
  for (const Joint& joint : world.scene().joints)
    if (joint.b && !joint.collide) apart.insert(std::minmax(joint.a, *joint.b));
  const auto moves = [&](std::uint32_t id) {
    return initial.motion.empty() || initial.motion[id] == Motion::dynamic;
  };
  Depth depth;
  world.detect();
  for (const auto& [a, b] : world.pairs())
    if ((moves(a) || moves(b)) && !apart.contains({a, b}))
      depth.see(initial.radius[a] + initial.radius[b] - (bodies.position[b] - bodies.position[a]).norm(), a);
  for (std::uint32_t id = 0; id < bodies.position.size(); ++id) {
    if (!moves(id)) continue;
    const Vector3d& x = bodies.position[id];
    for (const Plane& plane : world.scene().obstacles)
      depth.see(initial.radius[id] - (plane.normal.dot(x) - plane.offset), id);
    if (initial.box)
      depth.see(
          initial.radius[id] - std::min((x - initial.box->min).minCoeff(), (initial.box->max - x).minCoeff()),
          id);
  }
  return depth.body;
}

}  // namespace

std::optional<std::uint32_t> offending_body(World& world, BreakCondition condition) {
  if (condition == BreakCondition::energy_rise || condition == BreakCondition::stage_ms) return std::nullopt;
  if (condition == BreakCondition::penetration) return deepest(world);
  const BodyStates bodies = world.bodies();
  const std::optional<Box>& box = world.initial().box;
  std::optional<std::uint32_t> found;
  double fastest = -1;
  for (std::uint32_t id = 0; id < bodies.position.size(); ++id) {
    const Vector3d& x = bodies.position[id];
    const double speed = bodies.velocity[id].norm();
    switch (condition) {
      case BreakCondition::non_finite:
        if (!is_finite(x) || !is_finite(bodies.velocity[id]) || !is_finite(bodies.angular_velocity[id]) ||
            !bodies.orientation[id].coeffs().array().isFinite().all())
          return id;
        break;
      case BreakCondition::escaped:
        if (box && !((x - box->min).minCoeff() >= 0 && (box->max - x).minCoeff() >= 0)) return id;
        break;
      default:
        if (!(speed <= fastest)) {
          found = id;
          fastest = speed;
        }
    }
  }
  return found;
}

}  // namespace collidoscope
