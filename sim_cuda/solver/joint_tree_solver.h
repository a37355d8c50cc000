#pragma once
// Direct solver of the rigid joints of a tree (scene/joint_trees.h), and of its closing joints
// (joint_tree_closings.h). One item solves one tree: Newton's
// method on the velocities of all bodies and the impulses of all joints of a substep, with the exact
// derivative. Each pass eliminates the bodies from the leaves to the root; with n bodies it costs O(n)
// (Featherstone 1983).
//
// Trees that touch nothing conserve energy for every h, with the scheme energy_momentum of tree_joint.h: the
// velocities of solve are the means over the substep, and the first relax adds the change by the joints once
// more. Relax then removes the velocity error of the joints. Position errors are corrected by a velocity that
// ends with the move; the potential energy that it adds is push_work. Warm starting is not needed.
//
// A body that may spin freely about an axis (TreeNode::spin_axis) is a rotor in a frame that does not spin:
// the spin is constant and only adds its momentum. So gyroscopes are right for any spin.
//
// If Newton's method does not converge, because a body turns by about 1 rad in a substep or a loop is nearly
// singular, only the velocity error is removed. Later substeps correct the position.

#include "sim_cuda/solver/joint_tree_elimination.h"

namespace collidoscope {

template <class Real>
struct JointTreeSolver : JointTreeElimination<Real> {
  using Motion = JointTreeMotion<Real>;
  using Elimination = JointTreeElimination<Real>;
  using Closings = JointTreeClosings<Real>;
  using Elimination::eliminate, Elimination::substitute;
  using Motion::angular, Motion::bodies, Motion::body_of, Motion::fixed_body, Motion::gravity, Motion::h,
      Motion::linear, Motion::load, Motion::store, Motion::trees, Motion::widened_row;

  StaticImpulse* static_impulses;  ///< by body, or null

  static constexpr int max_passes = 12;
  static constexpr double tolerance = 1e-8;  ///< of the last pass, relative to size and 1 rad

  /// Call before solve, once per substep, after the members are set.
  SIM_HD void begin(std::int64_t tree) const {
    if (is_free(tree)) apply_carried_impulses(tree);
    clear_closings(tree);
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      TreeNodeState& state = trees.states[node];
      for (int k = 0; k < 6; ++k) state.change[k] = state.correction[k] = state.impulse[k] = 0;
      state.limit = state.falls = 0;
      const std::uint32_t body = trees.nodes[node].body;
      state.rotor = Vector3d(0, 0, 0);
      if (bodies.orientation == nullptr) continue;
      const Vector3<Real> spin = bodies.angular_velocity[body];
      const Vector3d axis = widened<Real>(bodies.orientation[body]) * trees.nodes[node].spin_axis;
      state.rotor = axis.dot(widened<Real>(spin)) * axis;
    }
  }

  /// `again`: after the contacts, which have changed velocities, or not.
  SIM_HD void solve(std::int64_t tree, bool again) const {
    if (again) save_positions(tree);
    if (again && is_unchanged(tree)) return;
    const TreeScheme scheme = is_free(tree) ? TreeScheme::energy_momentum : TreeScheme::start_pose;
    load(tree, true);
    bool solved = false;
    for (int pass = 0; pass < max_passes && !solved; ++pass) {
      bool limits_changed = false;
      if (!eliminate(tree, scheme, limits_changed)) break;
      const double step = substitute(tree, scheme, true);
      if (!(step < 1e100)) break;
      solved = step < tolerance && !limits_changed;
    }
    if (!solved || (scheme == TreeScheme::start_pose && turns_too_far(tree))) remove_velocity_error(tree);
    limit_correction(tree);
    if (trees.correction != nullptr) store_corrections(tree);
    add_fall(tree, !solved && scheme == TreeScheme::energy_momentum);
    store(tree, true);
  }

  /// `first`: of the substep.
  SIM_HD void relax(std::int64_t tree, bool first) const {
    if (first) end_move(tree);
    load(tree, false);
    bool limits_changed = false;
    const bool solved = eliminate(tree, TreeScheme::velocities, limits_changed) &&
                        substitute(tree, TreeScheme::velocities, false) < 1e100;
    if (solved) store(tree, false);
    if (first) carry_impulses(tree, solved);
  }

 private:
  SIM_HD void clear_closings(std::int64_t tree) const {
    for (std::uint32_t k = Closings::first_closing(tree); k < Closings::last_closing(tree); ++k) {
      for (double& impulse : trees.closing_states[k].impulse) impulse = 0;
      trees.closing_states[k].limit = 0;
    }
  }
  /// True if no velocity has changed since the last solve.
  SIM_HD bool is_unchanged(std::int64_t tree) const {
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      const TreeNodeState& state = trees.states[node];
      const std::uint32_t body = trees.nodes[node].body;
      const Vector3<Real> v = bodies.velocity[body];
      Vector3<Real> w = Vector3<Real>::Zero();
      if (bodies.orientation != nullptr) w = bodies.angular_velocity[body];
      for (int k = 0; k < 3; ++k)
        if (v[k] != static_cast<Real>(state.velocity[k] + state.correction[k]) ||
            w[k] != static_cast<Real>(state.velocity[3 + k] + (state.correction[3 + k] + state.rotor[k])))
          return false;
    }
    return true;
  }
  SIM_HD void save_positions(std::int64_t tree) const {
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node)
      trees.states[node].position = widened<Real>(bodies.position[trees.nodes[node].body]);
  }
  SIM_HD bool is_free(std::int64_t tree) const {
    return trees.members[trees.nodes[trees.begin[tree]].body] == TreeMember::free;
  }

  // Relax removes a velocity along the joints that is s at the end of a substep if it is 0 at its start, and
  // s - r if it is r. If s / 2 is added at the start, as much energy is added as removed, and the method is
  // symmetric. The impulse of s / 2 is carried from substep to substep while its energy is a small part of
  // the tree's.

  static constexpr double carried_energy = 1e-6;  ///< of the kinetic energy

  SIM_HD void apply_carried_impulses(std::int64_t tree) const {
    load(tree, false);
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      const TreeNode at = trees.nodes[node];
      if (at.joint == TreeNode::none) continue;
      double carried[TreeJoint::max_rows];
      load_carried(at.joint, carried);
      const JointRow<double> joint = widened_row(trees.rows[at.joint]);
      const bool has_parent = at.parent != TreeNode::none;
      TreeNodeState& state = trees.states[node];
      const int end = joint.a == at.body ? 0 : 1;
      const TreeBody own = body_of(at.body, state.velocity, TreeScheme::velocities);
      const TreeBody other =
          has_parent
              ? body_of(trees.nodes[at.parent].body, trees.states[at.parent].velocity, TreeScheme::velocities)
              : fixed_body(end == 0 ? joint.b : joint.a, joint, TreeScheme::velocities);
      int limit = 0;
      const TreeJoint equations(joint, TreeScheme::velocities, h(), end == 0 ? own : other,
                                end == 0 ? other : own, carried, limit, false);
      for (int row = 0; row < equations.rows; ++row) {
        const double impulse = carried[equations.impulse_of[row]];
        add_impulse(own, static_cast<double>(bodies.mass[at.body]), impulse, equations.force[row], end,
                    state);
        if (has_parent)
          add_impulse(other, static_cast<double>(bodies.mass[trees.nodes[at.parent].body]), impulse,
                      equations.force[row], 1 - end, trees.states[at.parent]);
      }
    }
    for (std::uint32_t k = Closings::first_closing(tree); k < Closings::last_closing(tree); ++k)
      apply_carried_closing(trees.closings[k]);
    store(tree, false);
  }
  SIM_HD void apply_carried_closing(const TreeClosing& closing) const {
    double carried[TreeJoint::max_rows];
    load_carried(closing.joint, carried);
    int limit = 0;
    Closings::with_equations(
        closing, TreeScheme::velocities, carried, limit, false,
        [&](const TreeJoint& equations, const TreeBody& a, const TreeBody& b) {
          for (int end = 0; end < 2; ++end) {
            const std::uint32_t node = Closings::node_at(closing, end);
            if (node == TreeNode::none) continue;
            for (int row = 0; row < equations.rows; ++row)
              add_impulse(end == 0 ? a : b, static_cast<double>(bodies.mass[trees.nodes[node].body]),
                          carried[equations.impulse_of[row]], equations.force[row], end, trees.states[node]);
          }
        });
  }
  SIM_HD static void add_impulse(const TreeBody& body, double mass, double impulse,
                                 const TreeJoint::Pair& force, int end, TreeNodeState& state) {
    for (int k = 0; k < 3; ++k) state.velocity[k] += impulse / mass * force.linear[end][k];
    if (!body.turns) return;
    const Vector3d own = body.axes.conjugate() * Vector3d(impulse * force.angular[end]);
    const Vector3d change = body.axes * Vector3d(own.cwiseQuotient(body.inertia));
    for (int k = 0; k < 3; ++k) state.velocity[3 + k] += change[k];
  }
  SIM_HD void load_carried(std::uint32_t joint, double (&carried)[TreeJoint::max_rows]) const {
    const JointImpulse<Real>& stored = trees.impulses[joint];
    for (int k = 0; k < 3; ++k) carried[k] = static_cast<double>(stored.linear[k]);
    for (int k = 0; k < 2; ++k) carried[3 + k] = static_cast<double>(stored.perpendicular[k]);
    carried[5] = 0;  // limits are inelastic
  }
  /// Call after the first relax: `right` holds the change of the velocities.
  SIM_HD void carry_impulses(std::int64_t tree, bool solved) const {
    double removed = 0, kept = 0;
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      const TreeNodeState& state = trees.states[node];
      double change[6];
      for (int k = 0; k < 6; ++k) change[k] = state.right[k][0];
      removed += kinetic_energy(trees.nodes[node].body, change);
      kept += kinetic_energy(trees.nodes[node].body, state.velocity);
    }
    const bool carries = solved && is_free(tree) && removed <= carried_energy * kept;
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      const TreeNode at = trees.nodes[node];
      if (at.joint == TreeNode::none) continue;
      carry_impulse(at.joint, trees.states[node], carries);
    }
    for (std::uint32_t k = Closings::first_closing(tree); k < Closings::last_closing(tree); ++k)
      carry_impulse(trees.closings[k].joint, trees.closing_states[k], carries);
  }
  /// `state`: of the joint, TreeNodeState or TreeClosingState.
  template <class State>
  SIM_HD void carry_impulse(std::uint32_t joint, const State& state, bool carries) const {
    double carried[TreeJoint::max_rows];
    load_carried(joint, carried);
    for (int k = 0; k < TreeJoint::max_rows; ++k) carried[k] = carries ? carried[k] / 2 : 0.0;
    for (int row = 0; carries && row < state.rows; ++row)
      carried[state.impulse_of[row]] -= state.relaxed[row] / 2;
    JointImpulse<Real>& stored = trees.impulses[joint];
    for (int k = 0; k < 3; ++k) stored.linear[k] = static_cast<Real>(carried[k]);
    for (int k = 0; k < 2; ++k) stored.perpendicular[k] = static_cast<Real>(carried[3 + k]);
  }
  SIM_HD double kinetic_energy(std::uint32_t body, const double (&velocity)[6]) const {
    const Vector3d v = linear(velocity);
    double energy = static_cast<double>(bodies.mass[body]) / 2 * v.dot(v);
    if (bodies.orientation == nullptr) return energy;
    const Vector3d w = widened<Real>(bodies.orientation[body]).conjugate() * angular(velocity);
    return energy + w.dot(widened<Real>(bodies.inertia[body]).cwiseProduct(w)) / 2;
  }
  /// True if the joints turn a body by more than 0.5 rad. Forces at the start pose could add energy then.
  SIM_HD bool turns_too_far(std::int64_t tree) const {
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node)
      if (!(h() * length_of(angular(trees.states[node].change)) < 0.5)) return true;
    return false;
  }
  /// Limits the rotation by the correction to 0.25 rad. Bodies with small moments of inertia turn most.
  SIM_HD void limit_correction(std::int64_t tree) const {
    double largest = 0;
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node)
      largest = max_of(largest, h() * length_of(angular(trees.states[node].correction)));
    if (!(largest > 0.25)) return;
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node)
      for (int k = 0; k < 6; ++k) trees.states[node].correction[k] *= 0.25 / largest;
  }

  /// Removes the velocity error of the joints instead of solving for the end of the substep.
  SIM_HD void remove_velocity_error(std::int64_t tree) const {
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      TreeNodeState& state = trees.states[node];
      for (int k = 0; k < 6; ++k) state.change[k] = state.correction[k] = state.impulse[k] = 0;
      state.limit = 0;
      for (int k = 0; k < 6; ++k) state.velocity[k] = state.start[k];
    }
    clear_closings(tree);
    bool limits_changed = false;
    if (eliminate(tree, TreeScheme::velocities, limits_changed))
      substitute(tree, TreeScheme::velocities, true);
  }

  SIM_HD void store_corrections(std::int64_t tree) const {
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      const std::uint32_t body = trees.nodes[node].body;
      const TreeNodeState& state = trees.states[node];
      Vector3<Real> v, w;
      for (int k = 0; k < 3; ++k) {
        v[k] = static_cast<Real>(state.correction[k]);
        w[k] = static_cast<Real>(state.correction[3 + k]);
      }
      trees.correction[body] = v;
      trees.spin_correction[body] = w;
    }
  }
  /// Without forces at mean positions, a free tree moves by its velocity at the end of the substep, which is
  /// semi-implicit and loses energy, instead of h g / 2 less.
  SIM_HD void add_fall(std::int64_t tree, bool falls) const {
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      TreeNodeState& state = trees.states[node];
      state.falls = falls ? 1 : 0;
      for (int k = 0; falls && k < 3; ++k) state.correction[k] += h() / 2 * static_cast<double>(gravity[k]);
    }
  }

  /// From the velocities of the move to those at its end.
  SIM_HD void end_move(std::int64_t tree) const {
    const bool free = is_free(tree);
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      const TreeNodeState& state = trees.states[node];
      const std::uint32_t body = trees.nodes[node].body;
      const Vector3d moved = widened<Real>(bodies.velocity[body]);
      const double share = free ? 1 : 0;
      if (static_impulses != nullptr && free) {
        // By the correction, and by continuous collision, which may shorten the move. Not by rounding.
        const Vector3d pushed = widened<Real>(bodies.position[body]) - state.position -
                                h() * (moved - linear(state.correction) -
                                       (state.falls == 0 ? h() / 2 : 0.0) * widened<Real>(gravity));
        constexpr double rounding = sizeof(Real) == 4 ? 1e-4 : 1e-8;
        if (length_of(pushed) > rounding * trees.size[tree])
          static_impulses[body].push_work -=
              static_cast<double>(bodies.mass[body]) * widened<Real>(gravity).dot(pushed);
      }
      const Vector3d v = moved - linear(state.correction) + share * linear(state.change);
      bodies.velocity[body] = Vector3<Real>(v.cast<Real>());
      if (bodies.orientation == nullptr) continue;
      TreeBody turned;
      const Vector3<Real> stored = bodies.angular_velocity[body];
      const Vector3d rate = widened<Real>(stored) - state.rotor;
      turned.half = h() / 2 * rate;
      turned.scale = 1 / (1 + turned.half.dot(turned.half));
      turned.axes = cayley_rotation<double>(state.rotor, h()) * widened<Real>(bodies.orientation[body]);
      Quaternion<Real> axes = turned.next_axes().template cast<Real>();
      normalise(axes);
      bodies.orientation[body] = axes;
      Vector3d w = rate - angular(state.correction) + share * angular(state.change) + state.rotor;
      w += turned.change(w);
      const Vector3d inertia = widened<Real>(bodies.inertia[body]);
      if (!free && !(is_isotropic(inertia) && state.rotor.dot(state.rotor) == 0)) {
        // With forces at the start pose, only the inertia of rotation acts once more.
        const Quaterniond now = widened<Real>(axes);
        Vector3d mean = rate - angular(state.correction), rotor = state.rotor;
        mean += turned.change(mean);
        rotor += turned.change(rotor);
        mean = now.conjugate() * mean;
        const Vector3d momentum = inertia.cwiseProduct(mean + now.conjugate() * rotor);
        w -= now * Vector3d((h() / 2 * mean.cross(momentum)).cwiseQuotient(inertia));
      }
      bodies.angular_velocity[body] = Vector3<Real>(w.cast<Real>());
    }
  }
};

}  // namespace collidoscope
