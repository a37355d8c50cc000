#pragma once
// Stages of Joints (joints.h): iterations over colours, sums of springs, and the solver of trees.
// Short-lived.

#include "sim_cuda/solver/joint_constraint.h"
#include "sim_cuda/solver/joints.h"

namespace collidoscope {

template <class Real>
struct JointRounds {
  JointView<Real> joints;
  BodyView<Real> bodies;
  Real h;
  const StepControl* control;
  const std::uint8_t* asleep;  ///< by body; null without the effect sleeping
  SpringImpulses<Real> springs;
  static constexpr bool static_item_counts = true;
  SIM_HD std::int64_t items(int round) const {
    return control->overflow ? 0 : joints.begin[round + 1] - joints.begin[round];
  }
  SIM_HD std::size_t place(int round, int item) const {
    return joints.begin[round] + static_cast<std::uint32_t>(item);
  }
  SIM_HD bool sleeps(const JointRow<Real>& joint) const {
    return asleep != nullptr && (asleep[joint.a] || (joint.b != PlacedJoint::world && asleep[joint.b]));
  }
  /// Adds an impulse of a spring, `along` the line from a's anchor to b's.
  template <class Ends>
  SIM_HD void add_spring(const JointRow<Real>& joint, const Ends& ends, Real along) const {
    if (springs.impulse == nullptr || joint.kind != JointKind::spring) return;
    using std::sqrt;
    const Real length = sqrt(ends.separation.dot(ends.separation));
    const Vector3<Real> by =
        along * (length > 0 ? Vector3<Real>(ends.separation / length) : Vector3<Real>(0, 0, 1));
    if (ends.a.inverse_mass > 0) springs.add(joint.a, -by, ends.a.arm);
    if (ends.b.inverse_mass > 0) springs.add(joint.b, by, ends.b.arm);
  }
};

template <class Real, bool with_rotation>
struct WarmStartJoints : JointRounds<Real> {
  SIM_HD void operator()(int round, int item) const {
    const std::size_t place = this->place(round, item);
    const JointRow<Real>& joint = this->joints.rows[place];
    if (this->sleeps(joint)) return;
    JointImpulse<Real> accumulated = this->joints.impulses[place];
    JointEnds<Real, with_rotation> ends(this->bodies, joint);
    JointConstraint<Real, with_rotation>(joint, accumulated, ends, this->h).warm_start();
    this->add_spring(joint, ends, accumulated.linear.x());
    ends.store(this->bodies, joint);
    this->joints.impulses[place] = accumulated;
  }
};

template <class Real, bool with_rotation, JointPhase phase>
struct IterateJoints : JointRounds<Real> {
  SIM_HD void operator()(int round, int item) const {
    const std::size_t place = this->place(round, item);
    const JointRow<Real>& joint = this->joints.rows[place];
    if (this->sleeps(joint) || (phase != JointPhase::solve && joint.kind == JointKind::spring)) return;
    JointImpulse<Real> accumulated = this->joints.impulses[place];
    const Real before = accumulated.linear.x();
    JointEnds<Real, with_rotation> ends(this->bodies, joint);
    JointConstraint<Real, with_rotation>(joint, accumulated, ends, this->h).template iterate<phase>();
    if constexpr (phase == JointPhase::solve) this->add_spring(joint, ends, accumulated.linear.x() - before);
    ends.store(this->bodies, joint);
    if constexpr (phase != JointPhase::correct) this->joints.impulses[place] = accumulated;
  }
};

template <class Real>
struct ClearSprings {
  const std::uint32_t* bodies;
  SpringImpulses<Real> springs;
  const StepControl* control;
  SIM_HD void operator()(int item) const {
    if (control->overflow) return;
    const std::uint32_t body = bodies[item];
    springs.impulse[body] = springs.moment[body] = Vector3<Real>(Vector3<Real>::Zero());
  }
};

/// Adds the energy by which corrections have stretched springs to push_work. Call after the move.
template <class Real, bool with_rotation>
struct AddSpringPushWork : JointRounds<Real> {
  BodyView<Real> corrections;
  StaticImpulse* static_impulses;
  SIM_HD void operator()(int round, int item) const {
    const JointRow<Real>& joint = this->joints.rows[this->place(round, item)];
    if (joint.kind != JointKind::spring || this->sleeps(joint)) return;
    const JointEnds<Real, with_rotation> ends(this->bodies, joint), by(corrections, joint);
    const Vector3<Real> moved = this->h * (by.b.velocity_at(by.b.arm) - by.a.velocity_at(by.a.arm));
    if (moved.dot(moved) == 0) return;
    using std::sqrt;
    const Real length = sqrt(ends.separation.dot(ends.separation));
    if (!(length > 0)) return;
    const Vector3<Real> other = ends.separation - moved;
    if (!(joint.spring > 0)) return;
    const auto stretch = static_cast<double>(length - joint.low),
               before = static_cast<double>(Real(sqrt(other.dot(other))) - joint.low);
    static_impulses[ends.a.inverse_mass > 0 ? joint.a : joint.b].push_work +=
        static_cast<double>(joint.spring) * (stretch * stretch - before * before) / 2;
  }
};

/// Starts a substep. A tree touches something if one of its bodies got an impulse in the last substep.
template <class Real>
struct BeginTrees {
  JointTreeSolver<Real> solver;
  ImpulsesByBody<Real> impulses;
  const StepControl* control;
  SIM_HD void operator()(int tree) const {
    if (control->overflow) return;
    const JointTreeView<Real>& trees = solver.trees;
    bool touches_any = false;
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1] && !touches_any; ++node)
      touches_any = impulses.touches(static_cast<int>(trees.nodes[node].body), *control);
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node)
      trees.members[trees.nodes[node].body] = touches_any ? TreeMember::touching : TreeMember::free;
    solver.begin(tree);
  }
};

/// Flags of the stages of trees are not template parameters: these kernels take longest to compile.
template <class Real>
struct TreeStage {
  JointTreeSolver<Real> solver;
  const StepControl* control;
  const std::uint8_t* asleep;  ///< by body; null without the effect sleeping
  SIM_HD bool skips(int tree) const {
    return control->overflow != 0 ||
           (asleep != nullptr && asleep[solver.trees.nodes[solver.trees.begin[tree]].body] != 0);
  }
};

template <class Real>
struct SolveTrees : TreeStage<Real> {
  bool again;  ///< see JointTreeSolver::solve()
  SIM_HD void operator()(int tree) const {
    if (!this->skips(tree)) this->solver.solve(tree, again);
  }
};

template <class Real>
struct RelaxTrees : TreeStage<Real> {
  bool first;                  ///< of the substep
  PackedVector3<Real>* moved;  ///< if first: EnergyGuard::moved_velocity(), see store_moved()
  SIM_HD void operator()(int tree) const {
    if (this->skips(tree)) return;
    this->solver.relax(tree, first);
    if (first) store_moved(tree);
  }
  /// The first relax turns velocities with the joints. In a tree that touches something, only what contacts
  /// remove after it is push_work.
  SIM_HD void store_moved(int tree) const {
    const JointTreeView<Real>& trees = this->solver.trees;
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      const std::uint32_t body = trees.nodes[node].body;
      if (trees.members[body] == TreeMember::touching) moved[body] = this->solver.bodies.velocity[body];
    }
  }
};

template <class Real, bool with_rotation>
struct MeasureJoint {
  JointView<Real> joints;
  BodyView<Real> bodies;
  SIM_HD JointSums operator()(std::int64_t place) const {
    return measure_joint<Real, with_rotation>(bodies, joints.rows[place]);
  }
};

}  // namespace collidoscope
