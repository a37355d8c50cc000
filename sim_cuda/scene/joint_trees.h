#pragma once
// Trees of rigid joints. Two bodies are connected by each rod, rope, ball joint or hinge between them;
// springs connect nothing. A group of connected bodies is a tree if it has no loop; otherwise it has a
// spanning tree and closing joints. Several joints to the world or to bodies that do not respond to impulses
// form loops, too. Groups with few closing equations are solved directly (solver/joint_tree_solver.h), all
// others by iteration (solver/joint_constraint.h).

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

/// A joint that closes a loop of a group with a spanning tree.
struct TreeClosing {
  std::uint32_t joint;           ///< number of the joint
  std::uint32_t node_a, node_b;  ///< nodes of its bodies; none if fixed
};

struct JointTrees {
  /// Largest number of equations of the closing joints of a group. Groups with more are iterated.
  static constexpr int max_closing_rows = 18;
  std::vector<TreeClosing> closings;            ///< tree by tree
  std::vector<std::uint32_t> closing_begin{0};  ///< first closing joint of each tree, and the end
  std::vector<TreeNode> nodes;                  ///< tree by tree, each body before its parent
  std::vector<std::uint32_t> begin{0};          ///< first node of each tree, and the end
  std::vector<bool> in_tree;                    ///< by joint

  std::size_t count() const { return begin.size() - 1; }
};

/// Groups of connected bodies that contain a loop.
struct JointLoopGroups {
  static constexpr std::uint32_t none = 0xffffffffu;
  std::vector<std::uint32_t> bodies;    ///< group by group
  std::vector<std::uint32_t> begin{0};  ///< first body of each group, and the end
  std::vector<std::uint32_t> supports;  ///< bodies that do not respond, or the world, joined to each group
  std::vector<std::uint32_t> support_begin{0};

  std::size_t count() const { return begin.size() - 1; }
};

JointLoopGroups find_joint_loops(const std::vector<PlacedJoint>& joints, const std::vector<bool>& in_tree,
                                 const std::vector<bool>& responds);

/// `responds`: by body, true for dynamic bodies.
JointTrees find_joint_trees(const std::vector<PlacedJoint>& joints, const std::vector<bool>& responds);

/// Fills spin_axis in. `inertia`: principal moments by body.
void find_spin_axes(JointTrees& trees, const std::vector<PlacedJoint>& joints,
                    const std::vector<Vector3d>& inertia);

/// By body: true for dynamic bodies.
std::vector<bool> bodies_that_respond(const InitialBodies& bodies);

}  // namespace collidoscope
