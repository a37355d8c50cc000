#pragma once
// State of joint trees in a substep (joint_tree_solver.h): memory per body, and the motion of bodies for the
// equations of their joints.

#include <cstdint>

#include "sim_cuda/dynamics/cayley.h"
#include "sim_cuda/dynamics/tree_member.h"
#include "sim_cuda/scene/joint_trees.h"
#include "sim_cuda/solver/tree_joint.h"

namespace collidoscope {

/// State of a node in a substep, and memory of the elimination. Vectors are velocity, then spin.
struct TreeNodeState {
  double velocity[6];    ///< without the correction of position errors
  double start[6];       ///< the same without `change`
  Vector3d position;     ///< m, before the move
  Vector3d rotor;        ///< rad/s: spin about TreeNode::spin_axis, which the joints do not change
  double change[6];      ///< of the velocity, by the joints and by the inertia of rotation
  double correction[6];  ///< velocity that corrects position errors
  double impulse[TreeJoint::max_rows];  ///< of the joint, see TreeJoint
  double relaxed[TreeJoint::max_rows];  ///< impulses of relax, by equation
  int limit;                            ///< active limit of the joint: -1, 0, 1
  int falls;                            ///< 1: `correction` contains h g / 2, see add_fall()
  int rows;                             ///< equations of the joint
  int impulse_of[TreeJoint::max_rows];
  double block[6][6], right[6][2];  ///< from the children
  double solved[6 + TreeJoint::max_rows][8];
};

/// Columns of the closing equations at a node, see joint_tree_closings.h.
struct TreeColumns {
  double right[6][JointTrees::max_closing_rows];  ///< from the children; then the solution
  double solved[6 + TreeJoint::max_rows][JointTrees::max_closing_rows];
};

/// State of a joint that closes a loop.
struct TreeClosingState {
  double impulse[TreeJoint::max_rows];  ///< as TreeNodeState
  double relaxed[TreeJoint::max_rows];
  int limit, rows;
  int impulse_of[TreeJoint::max_rows];
  TreeJoint::Pair gradient[TreeJoint::max_rows];
  double residual[TreeJoint::max_rows][2];  ///< right side, and right side of the correction
  double unit[TreeJoint::max_rows];         ///< N s or N m s, unit of the impulses
};

template <class Real>
struct JointTreeView {
  const TreeNode* nodes = nullptr;
  const std::uint32_t* begin = nullptr;
  const double* size = nullptr;  ///< m, by tree: shortest arm or radius
  const JointRow<Real>* rows = nullptr;
  JointImpulse<Real>* impulses = nullptr;  ///< in order of `rows`; of trees: the carried impulses of relax
  TreeNodeState* states = nullptr;
  TreeMember* members = nullptr;  ///< by body
  std::int64_t count = 0;
  const TreeClosing* closings = nullptr;  ///< tree by tree; null without loops
  const std::uint32_t* closing_begin = nullptr;
  TreeClosingState* closing_states = nullptr;
  TreeColumns* columns = nullptr;                                        ///< by node; null without loops
  PackedVector3<Real>*correction = nullptr, *spin_correction = nullptr;  ///< by body; null without springs
};

/// Access to trees and bodies, for the solver.
template <class Real>
struct JointTreeMotion {
  JointTreeView<Real> trees;
  BodyView<Real> bodies;
  Vector3<Real> gravity;  ///< m/s^2
  Real substep;           ///< s

  SIM_HD double h() const { return static_cast<double>(substep); }

  /// Loads the velocities of a tree. `with_correction`: between begin and move, when they include the
  /// correction and the rotor.
  SIM_HD void load(std::int64_t tree, bool with_correction) const {
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      TreeNodeState& state = trees.states[node];
      const std::uint32_t body = trees.nodes[node].body;
      const Vector3<Real> v = bodies.velocity[body];
      Vector3<Real> w = Vector3<Real>::Zero();
      if (bodies.orientation != nullptr) w = bodies.angular_velocity[body];
      for (int k = 0; k < 3; ++k) {
        state.velocity[k] = static_cast<double>(v[k]) - (with_correction ? state.correction[k] : 0);
        state.velocity[3 + k] =
            static_cast<double>(w[k]) - (with_correction ? state.correction[3 + k] + state.rotor[k] : 0);
      }
      for (int k = 0; k < 6; ++k) state.start[k] = state.velocity[k] - state.change[k];
    }
  }
  SIM_HD void store(std::int64_t tree, bool with_correction) const {
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      const TreeNodeState& state = trees.states[node];
      const std::uint32_t body = trees.nodes[node].body;
      Vector3<Real> v, w;
      for (int k = 0; k < 3; ++k) {
        v[k] = static_cast<Real>(state.velocity[k] + (with_correction ? state.correction[k] : 0));
        w[k] = static_cast<Real>(state.velocity[3 + k] +
                                 (with_correction ? state.correction[3 + k] + state.rotor[k] : 0));
      }
      bodies.velocity[body] = v;
      if (bodies.orientation != nullptr) bodies.angular_velocity[body] = w;
    }
  }
  SIM_HD static Vector3d linear(const double (&v)[6]) { return {v[0], v[1], v[2]}; }
  SIM_HD static Vector3d angular(const double (&v)[6]) { return {v[3], v[4], v[5]}; }

  SIM_HD TreeBody body_of(std::uint32_t body, const double (&velocity)[6], TreeScheme scheme) const {
    TreeBody moved;
    moved.responds = bodies.inverse_mass[body] > 0;
    moved.turns = bodies.orientation != nullptr;
    moved.position = widened<Real>(bodies.position[body]);
    moved.velocity = linear(velocity);
    moved.spin = angular(velocity);
    if (moved.turns) {
      moved.axes = widened<Real>(bodies.orientation[body]);
      moved.inertia = widened<Real>(bodies.inertia[body]);
    }
    if (scheme == TreeScheme::velocities) return moved;
    moved.half = h() / 2 * moved.spin;
    moved.scale = 1 / (1 + moved.half.dot(moved.half));
    moved.displacement = h() * moved.velocity;
    if (moved.responds && scheme == TreeScheme::energy_momentum)
      moved.displacement -= h() * h() / 2 * widened<Real>(gravity);
    return moved;
  }
  /// A body that does not respond, or the world.
  SIM_HD TreeBody fixed_body(std::uint32_t body, const JointRow<double>& joint, TreeScheme scheme) const {
    if (body == JointRow<Real>::world) {
      TreeBody world;
      world.position = joint.anchor_b;
      return world;
    }
    const Vector3<Real> v = bodies.velocity[body];
    Vector3<Real> w = Vector3<Real>::Zero();
    if (bodies.orientation != nullptr) w = bodies.angular_velocity[body];
    const double velocity[6] = {static_cast<double>(v.x()), static_cast<double>(v.y()),
                                static_cast<double>(v.z()), static_cast<double>(w.x()),
                                static_cast<double>(w.y()), static_cast<double>(w.z())};
    return body_of(body, velocity, scheme);
  }
  SIM_HD static JointRow<double> widened_row(const JointRow<Real>& row) {
    JointRow<double> wide{};
    wide.a = row.a;
    wide.b = row.b;
    wide.kind = row.kind;
    wide.limited = row.limited;
    wide.anchor_a = widened<Real>(row.anchor_a);
    wide.anchor_b = widened<Real>(row.anchor_b);
    wide.max_correction_speed = static_cast<double>(row.max_correction_speed);
    wide.low = static_cast<double>(row.low);
    wide.high = static_cast<double>(row.high);
    wide.axis_a = widened<Real>(row.axis_a);
    wide.axis_b = widened<Real>(row.axis_b);
    wide.side = widened<Real>(row.side);
    wide.start = widened<Real>(row.start);
    wide.low_cosine = static_cast<double>(row.low_cosine);
    wide.low_sine = static_cast<double>(row.low_sine);
    wide.high_cosine = static_cast<double>(row.high_cosine);
    wide.high_sine = static_cast<double>(row.high_sine);
    return wide;
  }
};

}  // namespace collidoscope
