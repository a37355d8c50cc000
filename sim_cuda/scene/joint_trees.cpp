#include "sim_cuda/scene/joint_trees.h"

#include <algorithm>
#include <iterator>
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

/// Largest number of equations of a joint.
int equations_of(const PlacedJoint& joint) {
  if (joint.kind == JointKind::distance) return 1;
  return joint.kind == JointKind::ball ? 3 : joint.limited ? 6 : 5;
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
  std::vector<std::vector<Neighbour>> neighbours(responds.size());
  std::vector<std::vector<std::uint32_t>> supports(responds.size());  // by body: joints to fixed bodies
  for (std::uint32_t k = 0; k < joints.size(); ++k) {
    const PlacedJoint& joint = joints[k];
    if (joint.kind == JointKind::spring || (!moves(joint.a) && !moves(joint.b))) continue;
    if (moves(joint.a) && moves(joint.b)) {
      neighbours[joint.a].push_back({joint.b, k});
      neighbours[joint.b].push_back({joint.a, k});
      groups.join(joint.a, joint.b);
    } else {
      supports[moves(joint.a) ? joint.a : joint.b].push_back(k);
    }
  }
  std::vector<std::uint32_t> root(responds.size(), TreeNode::none);  // by group: the last supported body
  for (std::uint32_t body = 0; body < responds.size(); ++body)
    if (!supports[body].empty()) root[groups.root(body)] = body;

  JointTrees trees;
  trees.in_tree.assign(joints.size(), false);
  std::vector<std::uint32_t> node_of(responds.size(), TreeNode::none);
  std::vector<bool> is_taken(joints.size(), false);
  for (std::uint32_t group = 0; group < responds.size(); ++group) {
    if (!responds[group] || groups.root(group) != group) continue;
    const std::uint32_t first = root[group] != TreeNode::none ? root[group] : group;
    if (neighbours[first].empty() && supports[first].empty()) continue;
    // Breadth first from the root; then the order is reversed, so that each body comes before its parent.
    std::vector<TreeNode> nodes;
    std::vector<std::uint32_t> closing;
    const auto add = [&](std::uint32_t body, std::uint32_t parent, std::uint32_t joint) {
      node_of[body] = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back({body, parent, joint, Vector3d(0, 0, 0)});
      if (joint != TreeNode::none) is_taken[joint] = true;
    };
    add(first, TreeNode::none, supports[first].empty() ? TreeNode::none : supports[first].back());
    for (std::uint32_t place = 0; place < nodes.size(); ++place) {
      const std::uint32_t body = nodes[place].body;
      for (const Neighbour& next : neighbours[body]) {
        if (is_taken[next.joint]) continue;
        if (node_of[next.body] == TreeNode::none) {
          add(next.body, place, next.joint);
        } else {
          is_taken[next.joint] = true;
          closing.push_back(next.joint);
        }
      }
      for (const std::uint32_t joint : supports[body])
        if (!is_taken[joint]) closing.push_back(joint);
    }
    int rows = 0;
    for (const std::uint32_t joint : closing) rows += equations_of(joints[joint]);
    if (rows > JointTrees::max_closing_rows) continue;
    const auto base = static_cast<std::uint32_t>(trees.nodes.size());
    const auto last = base + static_cast<std::uint32_t>(nodes.size()) - 1;
    const auto node_at = [&](std::uint32_t body) {
      return moves(body) ? last - node_of[body] : TreeNode::none;
    };
    for (const std::uint32_t joint : closing) {
      trees.in_tree[joint] = true;
      trees.closings.push_back({joint, node_at(joints[joint].a), node_at(joints[joint].b)});
    }
    trees.closing_begin.push_back(static_cast<std::uint32_t>(trees.closings.size()));
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

JointLoopGroups find_joint_loops(const std::vector<PlacedJoint>& joints, const std::vector<bool>& in_tree,
                                 const std::vector<bool>& responds) {
  const auto moves = [&](std::uint32_t body) { return body != PlacedJoint::world && responds[body]; };
  Groups groups(responds.size());
  std::vector<bool> is_member(responds.size(), false);
  const auto each_rigid = [&](const auto& visit) {
    for (std::size_t k = 0; k < joints.size(); ++k)
      if (!in_tree[k] && joints[k].kind != JointKind::spring) visit(joints[k]);
  };
  each_rigid([&](const PlacedJoint& joint) {
    if (moves(joint.a)) is_member[joint.a] = true;
    if (moves(joint.b)) is_member[joint.b] = true;
    if (moves(joint.a) && moves(joint.b)) groups.join(joint.a, joint.b);
  });
  std::vector<std::vector<std::uint32_t>> bodies(responds.size()), supports(responds.size());  // by root
  for (std::uint32_t body = 0; body < responds.size(); ++body)
    if (is_member[body]) bodies[groups.root(body)].push_back(body);
  each_rigid([&](const PlacedJoint& joint) {
    if (moves(joint.a) && !moves(joint.b)) supports[groups.root(joint.a)].push_back(joint.b);
    if (moves(joint.b) && !moves(joint.a)) supports[groups.root(joint.b)].push_back(joint.a);
  });
  JointLoopGroups loops;
  for (std::uint32_t root = 0; root < responds.size(); ++root) {
    if (bodies[root].empty()) continue;
    std::ranges::copy(bodies[root], std::back_inserter(loops.bodies));
    loops.begin.push_back(static_cast<std::uint32_t>(loops.bodies.size()));
    std::ranges::copy(supports[root], std::back_inserter(loops.supports));
    loops.support_begin.push_back(static_cast<std::uint32_t>(loops.supports.size()));
  }
  return loops;
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
