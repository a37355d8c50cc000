#pragma once
// Joints that close the loops of a group with a spanning tree (joint_tree_solver.h). They add one column per
// equation to the right sides of the tree: the response of all bodies to a unit impulse. With r equations, a
// dense system of r x r gives the impulses.
//
// Closing equations may depend on those of the tree, as in a planar loop of hinges. A small compliance makes
// the system regular; Newton's method, which repeats with the exact residual, removes its error.
//
// The change of a closing force by the motion of the body at the other end is neglected in the derivative.

#include "sim_cuda/solver/dense_solve.h"
#include "sim_cuda/solver/joint_tree_state.h"

namespace collidoscope {

template <class Real>
struct JointTreeClosings : JointTreeMotion<Real> {
  using Motion = JointTreeMotion<Real>;
  using Motion::bodies, Motion::body_of, Motion::fixed_body, Motion::h, Motion::trees, Motion::widened_row;

  static constexpr int max_columns = JointTrees::max_closing_rows;
  /// Relative to the inverse mass of an equation without the other joints. That of the correction of position
  /// errors is larger, because no error in the position of a nearly singular loop is worth a large move.
  static constexpr double compliance = 1e-6, correction_compliance = 1e-2;

  SIM_HD std::uint32_t first_closing(std::int64_t tree) const {
    return trees.closings != nullptr ? trees.closing_begin[tree] : 0;
  }
  SIM_HD std::uint32_t last_closing(std::int64_t tree) const {
    return trees.closings != nullptr ? trees.closing_begin[tree + 1] : 0;
  }
  SIM_HD bool has_closings(std::int64_t tree) const { return first_closing(tree) < last_closing(tree); }
  /// Number of closing equations, after add_closings().
  SIM_HD int closing_rows(std::int64_t tree) const {
    int rows = 0;
    for (std::uint32_t k = first_closing(tree); k < last_closing(tree); ++k)
      rows += trees.closing_states[k].rows;
    return rows;
  }

  SIM_HD static double component(const TreeJoint::Pair& pair, int end, int k) {
    return k < 3 ? pair.linear[end][k] : pair.angular[end][k - 3];
  }
  SIM_HD std::uint32_t node_at(const TreeClosing& closing, int end) const {
    return end == 0 ? closing.node_a : closing.node_b;
  }
  /// Equations of a closing joint at the current velocities.
  template <class Use>
  SIM_HD void with_equations(const TreeClosing& closing, TreeScheme scheme, double* impulse, int& limit,
                             bool adapt, const Use& use) const {
    const JointRow<double> joint = widened_row(trees.rows[closing.joint]);
    const auto end_of = [&](std::uint32_t node, std::uint32_t body) {
      return node != TreeNode::none ? body_of(body, trees.states[node].velocity, scheme)
                                    : fixed_body(body, joint, scheme);
    };
    const TreeBody a = end_of(closing.node_a, joint.a), b = end_of(closing.node_b, joint.b);
    use(TreeJoint(joint, scheme, h(), a, b, impulse, limit, adapt), a, b);
  }

  /// Adds the impulses of the closing joints to the sums of the nodes, and their columns. Call after the sums
  /// are cleared.
  SIM_HD void add_closings(std::int64_t tree, TreeScheme scheme, bool& limits_changed) const {
    if (!has_closings(tree)) return;
    const int columns = max_columns;
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node)
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < columns; ++j) trees.columns[node].right[i][j] = 0;
    int column = 0;
    for (std::uint32_t k = first_closing(tree); k < last_closing(tree); ++k) {
      const TreeClosing closing = trees.closings[k];
      TreeClosingState& state = trees.closing_states[k];
      const int limit = state.limit;
      with_equations(closing, scheme, state.impulse, state.limit, scheme != TreeScheme::velocities,
                     [&](const TreeJoint& equations, const TreeBody& a, const TreeBody& b) {
                       state.rows = equations.rows;
                       for (int row = 0; row < equations.rows; ++row, ++column)
                         add_row(closing, equations, row, column, scheme, state);
                       if (scheme != TreeScheme::energy_momentum) return;
                       for (int end = 0; end < 2; ++end) {
                         if (node_at(closing, end) == TreeNode::none) continue;
                         TreeNodeState& node = trees.states[node_at(closing, end)];
                         for (int j = 0; j < ((end == 0 ? a : b).turns ? 6 : 3); ++j) {
                           const TreeJoint::Pair change = equations.stiffness(state.impulse, end, j);
                           for (int i = 0; i < 6; ++i) node.block[i][j] -= component(change, end, i);
                         }
                       }
                     });
      if (state.limit != limit) limits_changed = true;
    }
  }
  SIM_HD void add_row(const TreeClosing& closing, const TreeJoint& equations, int row, int column,
                      TreeScheme scheme, TreeClosingState& state) const {
    state.impulse_of[row] = equations.impulse_of[row];
    state.gradient[row] = equations.gradient[row];
    state.residual[row][0] = -equations.error_rate[row];
    state.residual[row][1] = equations.correction[row];
    state.unit[row] = 0;
    const double impulse = scheme == TreeScheme::velocities ? 0.0 : state.impulse[equations.impulse_of[row]];
    for (int end = 0; end < 2; ++end) {
      const std::uint32_t node = node_at(closing, end);
      if (node == TreeNode::none) continue;
      const std::uint32_t body = trees.nodes[node].body;
      const double mass = static_cast<double>(bodies.mass[body]);
      Vector3d moment = equations.gradient[row].angular[end];
      if (bodies.orientation != nullptr) {
        const Quaterniond axes = widened<Real>(bodies.orientation[body]);
        moment =
            axes * Vector3d((axes.conjugate() * moment).cwiseQuotient(widened<Real>(bodies.inertia[body])));
        state.unit[row] += moment.dot(equations.gradient[row].angular[end]);
      }
      state.unit[row] += equations.gradient[row].linear[end].dot(equations.gradient[row].linear[end]) / mass;
    }
    // Impulses in units that change the speed of the joint by 1 without the other joints.
    state.unit[row] = state.unit[row] > 0 ? 1 / state.unit[row] : 0.0;
    for (int end = 0; end < 2; ++end) {
      const std::uint32_t node = node_at(closing, end);
      if (node == TreeNode::none) continue;
      for (int i = 0; i < 6; ++i) {
        const double force = component(equations.force[row], end, i);
        trees.states[node].right[i][0] += impulse * force;
        trees.columns[node].right[i][column] += state.unit[row] * force;
      }
    }
  }

  /// Solves for the closing impulses, and those of the correction. TreeColumns::right holds the solutions of
  /// the tree: velocities for each column; TreeNodeState::right those without closing impulses. Returns false
  /// if the system is singular.
  SIM_HD bool solve_closings(std::int64_t tree, double (&impulses)[max_columns][2]) const {
    return solve_closings(tree, 0, compliance, impulses) &&
           solve_closings(tree, 1, correction_compliance, impulses);
  }
  SIM_HD bool solve_closings(std::int64_t tree, int side, double softness,
                             double (&impulses)[max_columns][2]) const {
    double matrix[max_columns][max_columns], solved[max_columns][1];
    const int size = closing_rows(tree);
    int at = 0;
    for (std::uint32_t k = first_closing(tree); k < last_closing(tree); ++k) {
      const TreeClosing closing = trees.closings[k];
      const TreeClosingState& state = trees.closing_states[k];
      for (int row = 0; row < state.rows; ++row, ++at) {
        for (int j = 0; j < size; ++j) matrix[at][j] = at == j ? softness : 0;
        solved[at][0] = state.residual[row][side];
        for (int end = 0; end < 2; ++end) {
          const std::uint32_t node = node_at(closing, end);
          if (node == TreeNode::none) continue;
          for (int i = 0; i < 6; ++i) {
            const double gradient = component(state.gradient[row], end, i);
            for (int j = 0; j < size; ++j) matrix[at][j] += gradient * trees.columns[node].right[i][j];
            solved[at][0] -= gradient * trees.states[node].right[i][side];
          }
        }
      }
    }
    if (!solve_dense(matrix, solved, size, 1)) return false;
    for (int i = 0; i < size; ++i) impulses[i][side] = solved[i][0];
    return true;
  }
  /// Adds the solved impulses to those of the closing joints.
  SIM_HD void store_closings(std::int64_t tree, TreeScheme scheme,
                             const double (&impulses)[max_columns][2]) const {
    int at = 0;
    for (std::uint32_t k = first_closing(tree); k < last_closing(tree); ++k) {
      TreeClosingState& state = trees.closing_states[k];
      for (int row = 0; row < state.rows; ++row, ++at) {
        const double impulse = state.unit[row] * impulses[at][0];
        if (scheme == TreeScheme::velocities)
          state.relaxed[row] = impulse;
        else
          state.impulse[state.impulse_of[row]] += impulse;
      }
    }
  }
};

}  // namespace collidoscope
