#pragma once
// Trees of rigid joints. Two bodies are connected by each rod, rope, ball joint or hinge between them;
// springs connect nothing. A group of connected bodies is a tree if it has no loop. Several joints to the
// world or to bodies that do not respond to impulses form a loop, too. The joints of trees are solved
// directly (solver/joint_tree_solver.h), all others by iteration (solver/joint_constraint.h).

#include <cstdint>
#include <vector>

#include "sim_cuda/scene/placed_joint.h"

namespace collidoscope {

/// A body of a tree, and the joint towards the root.
struct TreeNode {
  static constexpr std::uint32_t none = 0xffffffffu;
  std::uint32_t body;
  std::uint32_t parent;  ///< node; none if this is a root
  std::uint32_t joint;  ///< number of the joint to the parent or, at a root, to a body that is fixed; or none
  /// Principal axis about which the body may spin freely: its moments of inertia are symmetric about it, and
  /// all joints act on it. Zero if there is none.
  Vector3d spin_axis;
};

struct JointTrees {
  std::vector<TreeNode> nodes;          ///< tree by tree, each body before its parent
  std::vector<std::uint32_t> begin{0};  ///< first node of each tree, and the end
  std::vector<bool> in_tree;            ///< by joint

  std::size_t count() const { return begin.size() - 1; }
};

/// `responds`: by body, true for dynamic bodies.
JointTrees find_joint_trees(const std::vector<PlacedJoint>& joints, const std::vector<bool>& responds);

/// Fills spin_axis in. `inertia`: principal moments by body.
void find_spin_axes(JointTrees& trees, const std::vector<PlacedJoint>& joints,
                    const std::vector<Vector3d>& inertia);

/// By body: true for dynamic bodies.
std::vector<bool> bodies_that_respond(const InitialBodies& bodies);

}  // namespace collidoscope
