#pragma once
// The linear systems of a joint tree (joint_tree_solver.h). They are eliminated body by body, from the leaves
// to the root.

#include "sim_cuda/solver/dense_solve.h"
#include "sim_cuda/solver/joint_tree_closings.h"

namespace collidoscope {

template <class Real>
struct JointTreeElimination : JointTreeClosings<Real> {
  using Motion = JointTreeMotion<Real>;
  using Closings = JointTreeClosings<Real>;
  using Closings::component, Closings::max_columns;
  using Motion::angular, Motion::bodies, Motion::body_of, Motion::fixed_body, Motion::h, Motion::trees,
      Motion::widened_row;

  static constexpr int max_size = 6 + TreeJoint::max_rows;

  /// The linear system of a body and its joint to the parent. Columns of `right`: velocity of the parent,
  /// right side, right side of the correction, closing equations.
  struct Block {
    double matrix[max_size][max_size], right[max_size][8 + max_columns];
    double parent[6][max_size];  ///< equations of the parent
  };

  /// Eliminates all bodies from the leaves to the root. Returns false if a system is singular.
  SIM_HD bool eliminate(std::int64_t tree, TreeScheme scheme, bool& limits_changed) const {
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      TreeNodeState& state = trees.states[node];
      for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) state.block[i][j] = 0;
        state.right[i][0] = state.right[i][1] = 0;
      }
    }
    Closings::add_closings(tree, scheme, limits_changed);
    const int closing_rows = Closings::closing_rows(tree);
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node)
      if (!eliminate_node(node, scheme, closing_rows, limits_changed)) return false;
    return true;
  }

  SIM_HD bool eliminate_node(std::uint32_t node, TreeScheme scheme, int closing_rows,
                             bool& limits_changed) const {
    const TreeNode at = trees.nodes[node];
    TreeNodeState& state = trees.states[node];
    const TreeBody own = body_of(at.body, state.velocity, scheme);
    const double mass = static_cast<double>(bodies.mass[at.body]);
    const double largest_inertia = max_of(own.inertia.x(), max_of(own.inertia.y(), own.inertia.z()));
    const int columns = 8 + closing_rows;
    Block block;
    for (int i = 0; i < max_size; ++i) {
      for (int j = 0; j < max_size; ++j) block.matrix[i][j] = 0;
      for (int j = 0; j < columns; ++j) block.right[i][j] = 0;
      for (int j = 0; j < 6; ++j) block.parent[j][i] = 0;
    }
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) block.matrix[i][j] = state.block[i][j];
      for (int j = 0; j < 2; ++j) block.right[i][6 + j] = state.right[i][j];
      for (int j = 0; j < closing_rows; ++j) block.right[i][8 + j] = trees.columns[node].right[i][j];
    }
    add_inertia(own, mass, state, scheme, block);
    state.rows = 0;
    const bool has_parent = at.parent != TreeNode::none;
    if (at.joint != TreeNode::none) add_joint(at, state, own, scheme, mass, block, limits_changed);
    for (int i = 0; i < 6; ++i) {
      const double scale = i < 3 ? 1 / mass : 1 / largest_inertia;
      for (int j = 0; j < 6 + state.rows; ++j) block.matrix[i][j] *= scale;
      for (int j = 0; j < columns; ++j) block.right[i][j] *= scale;
    }
    const int size = 6 + state.rows;
    if (!solve_dense(block.matrix, block.right, size, columns)) return false;
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < 8; ++j) state.solved[i][j] = block.right[i][j];
      for (int j = 0; j < closing_rows; ++j) trees.columns[node].solved[i][j] = block.right[i][8 + j];
    }
    if (!has_parent) return true;
    TreeNodeState& parent = trees.states[at.parent];
    for (int i = 0; i < 6; ++i)
      for (int k = 0; k < size; ++k) {
        const double factor = block.parent[i][k];
        if (factor == 0) continue;
        for (int j = 0; j < 6; ++j) parent.block[i][j] -= factor * block.right[k][j];
        for (int j = 0; j < 2; ++j) parent.right[i][j] -= factor * block.right[k][6 + j];
        for (int j = 0; j < closing_rows; ++j)
          trees.columns[at.parent].right[i][j] -= factor * block.right[k][8 + j];
      }
    return true;
  }

  /// Momentum of the body: m (v - v0) = impulses, and the same for the spin with the inertia of rotation.
  SIM_HD void add_inertia(const TreeBody& own, double mass, const TreeNodeState& state, TreeScheme scheme,
                          Block& block) const {
    const bool moves = scheme != TreeScheme::velocities;
    for (int i = 0; i < 3; ++i) {
      block.matrix[i][i] += mass;
      if (moves) block.right[i][6] -= mass * state.change[i];
    }
    if (!own.turns) {
      for (int i = 3; i < 6; ++i) block.matrix[i][i] += 1;
      return;
    }
    const bool turns_momentum = moves && (!is_isotropic(own.inertia) || state.rotor.dot(state.rotor) > 0);
    const bool isotropic = is_isotropic(own.inertia);
    const auto momentum = [&](const Vector3d& spin) {
      return isotropic ? Vector3d(own.inertia.x() * spin)
                       : Vector3d(own.axes * (own.inertia.cwiseProduct(own.axes.conjugate() * spin)));
    };
    const Vector3d angular_momentum = momentum(moves ? Vector3d(own.spin + state.rotor) : own.spin);
    for (int j = 0; j < 3; ++j) {
      const Vector3d e = unit_vector(j), change = momentum(e);
      const Vector3d turning = turns_momentum
                                   ? Vector3d(h() / 2 * (e.cross(angular_momentum) + own.spin.cross(change)))
                                   : Vector3d(0, 0, 0);
      for (int i = 0; i < 3; ++i) block.matrix[3 + i][3 + j] += change[i] + turning[i];
    }
    if (!moves) return;
    Vector3d residual = momentum(angular(state.change));
    if (turns_momentum) residual += h() / 2 * own.spin.cross(angular_momentum);
    for (int i = 0; i < 3; ++i) block.right[3 + i][6] -= residual[i];
  }

  SIM_HD void add_joint(const TreeNode& at, TreeNodeState& state, const TreeBody& own, TreeScheme scheme,
                        double mass, Block& block, bool& limits_changed) const {
    const JointRow<double> joint = widened_row(trees.rows[at.joint]);
    const bool has_parent = at.parent != TreeNode::none;
    const int end = joint.a == at.body ? 0 : 1, other_end = 1 - end;
    const TreeBody other =
        has_parent ? body_of(trees.nodes[at.parent].body, trees.states[at.parent].velocity, scheme)
                   : fixed_body(end == 0 ? joint.b : joint.a, joint, scheme);
    const int limit = state.limit;
    const TreeJoint equations(joint, scheme, h(), end == 0 ? own : other, end == 0 ? other : own,
                              state.impulse, state.limit, scheme != TreeScheme::velocities);
    if (state.limit != limit) limits_changed = true;
    state.rows = equations.rows;
    for (int row = 0; row < equations.rows; ++row) {
      const TreeJoint::Pair &force = equations.force[row], &gradient = equations.gradient[row];
      const int place = 6 + row;
      state.impulse_of[row] = equations.impulse_of[row];
      const double impulse =
          scheme == TreeScheme::velocities ? 0.0 : state.impulse[equations.impulse_of[row]];
      for (int k = 0; k < 6; ++k) {
        const double own_force = component(force, end, k);
        block.matrix[k][place] -= mass * own_force;  // impulses in units of the mass
        block.right[k][6] += impulse * own_force;
        block.matrix[place][k] += component(gradient, end, k);
        if (!has_parent) continue;
        const double parent_force = component(force, other_end, k);
        block.parent[k][place] -= mass * parent_force;
        trees.states[at.parent].right[k][0] += impulse * parent_force;
        block.right[place][k] += component(gradient, other_end, k);
      }
      block.right[place][6] -= equations.error_rate[row];
      block.right[place][7] += equations.correction[row];
    }
    if (scheme != TreeScheme::energy_momentum) return;
    const int components = own.turns ? 6 : 3;
    for (int k = 0; k < components; ++k) {
      const TreeJoint::Pair change = equations.stiffness(state.impulse, end, k);
      for (int i = 0; i < 6; ++i) {
        block.matrix[i][k] -= component(change, end, i);
        if (has_parent) block.parent[i][k] -= component(change, other_end, i);
      }
    }
    if (!has_parent) return;
    for (int k = 0; k < components; ++k) {
      const TreeJoint::Pair change = equations.stiffness(state.impulse, other_end, k);
      for (int i = 0; i < 6; ++i) {
        block.right[i][k] -= component(change, end, i);
        trees.states[at.parent].block[i][k] -= component(change, other_end, i);
      }
    }
  }

  /// Velocities of a body without the closing impulses, and by each of them. Call from the root to the
  /// leaves.
  SIM_HD void find_responses(std::uint32_t node, int closing_rows) const {
    TreeNodeState& state = trees.states[node];
    TreeColumns& own = trees.columns[node];
    const std::uint32_t up = trees.nodes[node].parent;
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < 2; ++k) state.right[i][k] = state.solved[i][6 + k];
      for (int k = 0; k < closing_rows; ++k) own.right[i][k] = own.solved[i][k];
      if (up == TreeNode::none) continue;
      for (int j = 0; j < 6; ++j) {
        const double factor = state.solved[i][j];
        for (int k = 0; k < 2; ++k) state.right[i][k] -= factor * trees.states[up].right[j][k];
        for (int k = 0; k < closing_rows; ++k) own.right[i][k] -= factor * trees.columns[up].right[j][k];
      }
    }
  }

  /// From the root to the leaves. Returns the largest change, relative to size and 1 rad.
  SIM_HD double substitute(std::int64_t tree, TreeScheme scheme, bool with_correction) const {
    double largest = 0, impulses[max_columns][2];
    const int closing_rows = Closings::closing_rows(tree);
    if (closing_rows > 0) {
      for (std::uint32_t node = trees.begin[tree + 1]; node-- > trees.begin[tree];)
        find_responses(node, closing_rows);
      if (!Closings::solve_closings(tree, impulses)) return 2e100;
      Closings::store_closings(tree, scheme, impulses);
    }
    const double per_metre = h() / trees.size[tree];
    for (std::uint32_t node = trees.begin[tree + 1]; node-- > trees.begin[tree];) {
      TreeNodeState& state = trees.states[node];
      const TreeNode at = trees.nodes[node];
      for (int i = 0; i < 6 + state.rows; ++i) {
        double step = state.solved[i][6], correction = state.solved[i][7];
        for (int j = 0; j < closing_rows; ++j) {
          step += trees.columns[node].solved[i][j] * impulses[j][0];
          correction += trees.columns[node].solved[i][j] * impulses[j][1];
        }
        if (at.parent != TreeNode::none) {
          const TreeNodeState& parent = trees.states[at.parent];
          for (int j = 0; j < 6; ++j) {
            step -= state.solved[i][j] * parent.right[j][0];
            correction -= state.solved[i][j] * parent.right[j][1];
          }
        }
        if (i >= 6) {
          const double impulse = static_cast<double>(bodies.mass[at.body]) * step;
          if (scheme == TreeScheme::velocities)
            state.relaxed[i - 6] = impulse;
          else
            state.impulse[state.impulse_of[i - 6]] += impulse;
          continue;
        }
        state.right[i][0] = step;  // the parent's solution, for its children
        state.right[i][1] = correction;
        state.velocity[i] += step;
        if (with_correction) state.correction[i] = correction;
        if (scheme == TreeScheme::velocities) continue;
        state.change[i] += step;
        const double relative = (step < 0 ? -step : step) * (i < 3 ? per_metre : h());
        if (!(relative <= largest)) largest = relative;  // also if it is not a number
      }
    }
    return largest;
  }
};

}  // namespace collidoscope
