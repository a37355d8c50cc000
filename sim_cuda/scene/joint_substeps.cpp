#include "sim_cuda/scene/joint_substeps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim_cuda/scene/joint_trees.h"

namespace collidoscope {
namespace {

constexpr int max_joint_substeps = 64;
constexpr double share = 0.01;  ///< allowed yield, relative to the joint's span

/// Smallest h^2 in s^2 that the joints require. Infinity if no joint has a requirement.
double least_square(const Scene& scene, const InitialBodies& bodies) {
  const std::vector<PlacedJoint> joints = place_joints(scene, bodies);
  const auto moves = [&](std::uint32_t body) {
    return body != PlacedJoint::world && (bodies.motion.empty() || bodies.motion[body] == Motion::dynamic);
  };
  const auto inverse_mass = [&](std::uint32_t body) { return moves(body) ? 1 / bodies.mass[body] : 0.0; };
  std::vector<std::uint32_t> group(bodies.size()), count(bodies.size(), 0);
  std::iota(group.begin(), group.end(), 0u);
  const auto root = [&](std::uint32_t body) {
    while (group[body] != body) body = group[body] = group[group[body]];
    return body;
  };
  for (const PlacedJoint& joint : joints) {
    if (moves(joint.a)) ++count[joint.a];
    if (moves(joint.b)) ++count[joint.b];
    if (moves(joint.a) && moves(joint.b)) group[root(joint.a)] = root(joint.b);
  }
  std::vector<double> mass(bodies.size(), 0);  // kg, total mass of each group of connected bodies
  for (std::uint32_t body = 0; body < bodies.size(); ++body) mass[root(body)] += bodies.mass[body];

  const double gravity = std::sqrt(scene.physics.gravity.dot(scene.physics.gravity));
  double least = std::numeric_limits<double>::infinity();
  const JointTrees trees = find_joint_trees(joints, bodies_that_respond(bodies));
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (trees.in_tree[k]) continue;
    const PlacedJoint& joint = joints[k];
    const bool world = joint.b == PlacedJoint::world;
    const std::uint32_t n = std::max(count[joint.a], world ? 0 : count[joint.b]);
    if (joint.kind == JointKind::spring || n < 2) continue;
    const Vector3d way = (world ? joint.anchor_b : bodies.position[joint.b]) - bodies.position[joint.a];
    const double span = std::max(std::sqrt(way.dot(way)), bodies.radius[joint.a]);
    const double felt = 1 / (inverse_mass(joint.a) + inverse_mass(joint.b));
    const double load = mass[root(moves(joint.a) ? joint.a : joint.b)] * gravity;
    if (load > 0) least = std::min(least, share * span * 4 * felt / (n * load));
  }
  return least;
}

/// Smallest number of substeps that joints require, if "auto" may choose it; otherwise 0.
double wanted_by_joints(const Scene& scene, const InitialBodies& bodies) {
  const Physics& physics = scene.physics;
  const bool off = scene.joints.empty() || (physics.effects && !physics.effects->joints);
  if (off || physics.substeps || physics.solver == Solver::impulse) return 0;
  return physics.time_step / std::sqrt(least_square(scene, bodies));
}

}  // namespace

double substeps_missed(const Scene& scene, const InitialBodies& bodies) {
  const double wanted = std::ceil(wanted_by_joints(scene, bodies));
  return wanted > max_joint_substeps ? wanted : 0;
}

int substeps_of(const Scene& scene, const InitialBodies& bodies) {
  const int usual = substeps_in_effect(scene.physics);
  const double wanted = wanted_by_joints(scene, bodies);
  return wanted > usual ? static_cast<int>(std::ceil(std::min<double>(wanted, max_joint_substeps))) : usual;
}

}  // namespace collidoscope
