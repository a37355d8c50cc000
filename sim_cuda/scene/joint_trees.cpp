#include "sim_cuda/scene/joint_trees.h"

#include <algorithm>
#include <numeric>

namespace collidoscope {
namespace {

class Groups {
 public:
  explicit Groups(std::size_t bodies) : parent_(bodies) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t root(std::uint32_t body) {
    while (parent_[body] != body) body = parent_[body] = parent_[parent_[body]];
    return body;
  }
  /// Returns false if a and b were in the same group.
  bool join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t x = root(a), y = root(b);
    parent_[std::max(x, y)] = std::min(x, y);
    return x != y;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

struct Neighbour {
  std::uint32_t body, joint;
};

/// True if `vector` is zero or parallel to the unit vector `axis`.
bool is_on_axis(const Vector3d& vector, const Vector3d& axis) {
  const Vector3d aside = vector.cross(axis);
  return aside.dot(aside) <= 1e-20 * vector.dot(vector);
}

/// True if a body with these principal moments is symmetric about the unit vector `axis`.
bool is_symmetric(const Vector3d& inertia, const Vector3d& axis) {
  if (inertia.x() == inertia.y() && inertia.y() == inertia.z()) return true;
  for (int k = 0; k < 3; ++k)
    if (is_on_axis(axis, Vector3d::Unit(k))) return inertia[(k + 1) % 3] == inertia[(k + 2) % 3];
  return false;
}

}  // namespace

std::vector<bool> bodies_that_respond(const InitialBodies& bodies) {
  std::vector<bool> responds(bodies.size(), true);
  for (std::size_t body = 0; body < bodies.motion.size(); ++body)
    responds[body] = bodies.motion[body] == Motion::dynamic;
  return responds;
}

JointTrees find_joint_trees(const std::vector<PlacedJoint>& joints, const std::vector<bool>& responds) {
  const auto moves = [&](std::uint32_t body) { return body != PlacedJoint::world && responds[body]; };
  Groups groups(responds.size());
  std::vector<bool> has_loop(responds.size(), false);  // by body; valid at the root of its group
  std::vector<std::uint32_t> support(responds.size(), TreeNode::none);  // by body: a joint to a fixed body
  std::vector<std::vector<Neighbour>> neighbours(responds.size());
  std::vector<std::uint32_t> looped;  // bodies at a joint that closes a loop
  for (std::uint32_t k = 0; k < joints.size(); ++k) {
    const PlacedJoint& joint = joints[k];
    if (joint.kind == JointKind::spring || (!moves(joint.a) && !moves(joint.b))) continue;
    if (moves(joint.a) && moves(joint.b)) {
      neighbours[joint.a].push_back({joint.b, k});
      neighbours[joint.b].push_back({joint.a, k});
      if (!groups.join(joint.a, joint.b)) looped.push_back(joint.a);
    } else {
      const std::uint32_t body = moves(joint.a) ? joint.a : joint.b;
      if (support[body] != TreeNode::none) looped.push_back(body);
      support[body] = k;
    }
  }
  for (const std::uint32_t body : looped) has_loop[groups.root(body)] = true;
  std::vector<std::uint32_t> root(responds.size(), TreeNode::none);  // by group: the body with the support
  for (std::uint32_t body = 0; body < responds.size(); ++body) {
    if (support[body] == TreeNode::none) continue;
    const std::uint32_t group = groups.root(body);
    if (root[group] != TreeNode::none) has_loop[group] = true;
    root[group] = body;
  }

  JointTrees trees;
  trees.in_tree.assign(joints.size(), false);
  for (std::uint32_t group = 0; group < responds.size(); ++group) {
    if (!responds[group] || groups.root(group) != group || has_loop[group]) continue;
    const std::uint32_t first = root[group] != TreeNode::none ? root[group] : group;
    if (neighbours[first].empty() && support[first] == TreeNode::none) continue;
    // Breadth first from the root; then the order is reversed, so that each body comes before its parent.
    std::vector<TreeNode> nodes{{first, TreeNode::none, support[first], Vector3d(0, 0, 0)}};
    for (std::uint32_t place = 0; place < nodes.size(); ++place)
      for (const Neighbour& next : neighbours[nodes[place].body])
        if (next.joint != nodes[place].joint)
          nodes.push_back({next.body, place, next.joint, Vector3d(0, 0, 0)});
    const auto base = static_cast<std::uint32_t>(trees.nodes.size());
    const auto last = base + static_cast<std::uint32_t>(nodes.size()) - 1;
    std::ranges::reverse(nodes);
    for (TreeNode& node : nodes) {
      if (node.parent != TreeNode::none) node.parent = last - node.parent;
      if (node.joint != TreeNode::none) trees.in_tree[node.joint] = true;
      trees.nodes.push_back(node);
    }
    trees.begin.push_back(last + 1);
  }
  return trees;
}

void find_spin_axes(JointTrees& trees, const std::vector<PlacedJoint>& joints,
                    const std::vector<Vector3d>& inertia) {
  constexpr std::size_t none = TreeNode::none;
  std::vector<std::size_t> node_of(inertia.size(), none);
  for (std::size_t k = 0; k < trees.nodes.size(); ++k) node_of[trees.nodes[k].body] = k;
  // Vectors of each node that a joint uses; all joints of a body count, also springs.
  std::vector<std::vector<Vector3d>> used(trees.nodes.size());
  std::vector<bool> limited(trees.nodes.size(), false);
  for (const PlacedJoint& joint : joints) {
    const auto add = [&](std::uint32_t body, const Vector3d& anchor, const Vector3d& axis) {
      if (body == PlacedJoint::world || node_of[body] == none) return;
      const std::size_t node = node_of[body];
      used[node].push_back(anchor);
      if (joint.kind == JointKind::hinge) used[node].push_back(axis);
      if (joint.kind == JointKind::hinge && joint.limited) limited[node] = true;
    };
    add(joint.a, joint.anchor_a, joint.axis);
    add(joint.b, joint.anchor_b, joint.start.conjugate() * joint.axis);
  }
  for (std::size_t k = 0; k < trees.nodes.size(); ++k) {
    Vector3d axis(0, 0, 0);
    for (const Vector3d& vector : used[k])
      if (axis.isZero(0) && !vector.isZero(0)) axis = vector.normalized();
    bool found = !axis.isZero(0) && !limited[k] && is_symmetric(inertia[trees.nodes[k].body], axis);
    for (const Vector3d& vector : used[k]) found = found && is_on_axis(vector, axis);
    if (found) trees.nodes[k].spin_axis = axis;
  }
}

}  // namespace collidoscope
