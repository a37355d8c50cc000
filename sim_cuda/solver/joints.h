#pragma once
// The joints of a scene in `soft_step`. Rigid joints of trees are solved directly (joint_tree_solver.h), all
// others by iteration, colour by colour. Colours are assigned once, first fit in scene order. Static and
// kinematic bodies and the world may occur several times in a colour. Created with the pipeline and has its
// lifetime. Each iteration is one call of the executor. After an overflow, nothing changes.

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/hashed_arrays.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/scene/placed_joint.h"
#include "sim_cuda/solver/joint_loops.h"
#include "sim_cuda/solver/joint_measure.h"
#include "sim_cuda/solver/joint_state.h"
#include "sim_cuda/solver/joint_tree_solver.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

template <class Real>
struct JointRounds;

template <class Real>
class Joints {
 public:
  /// `h`: substep, s. `gravity`: m/s^2, zero without the effect.
  /// `static_impulses`: by body, or null. `control` and the memory of `bodies` must outlive this object.
  Joints(Executor& executor, const std::vector<PlacedJoint>& joints, const InitialBodies& initial,
         const BodyView<Real>& bodies, const Vector3<Real>& gravity, StaticImpulse* static_impulses, Real h,
         const StepControl* control);

  std::int64_t count() const { return static_cast<std::int64_t>(rows_.size()); }
  int colours() const { return colours_; }
  JointView<Real> view() const { return {rows_.data(), impulses_.data(), begin_.data(), count()}; }

  /// By body: 1 if it has a joint.
  const std::uint8_t* is_jointed() const { return is_jointed_.data(); }
  /// By body; null without trees. begin_substep() writes it.
  TreeMember* members() const { return tree_count() == 0 ? nullptr : members_.data(); }
  LoopView<Real> loops() const { return loops_.view(); }
  /// Without memory unless there are springs and rigid joints.
  SpringImpulses<Real> spring_impulses() const {
    return spring_bodies_.size() == 0 ? SpringImpulses<Real>{}
                                      : SpringImpulses<Real>{spring_impulse_.data(), spring_moment_.data()};
  }
  /// Body pairs whose contacts are excluded by a joint.
  ExcludedPairs excluded_pairs() const {
    return {excluded_pairs_.data(), static_cast<std::uint32_t>(excluded_pairs_.size())};
  }

  /// Skips joints of sleeping bodies from now on. `asleep`: by body, 1 if asleep.
  void exclude_sleeping(const std::uint8_t* asleep) { asleep_ = asleep; }

  // Call once per substep each, in this order; bodies move between solve and relax.
  void begin_substep(const ImpulsesByBody<Real>& impulses);
  void warm_start();
  void solve();
  /// Call after the iterations. Contacts may have changed the velocities of trees.
  void end_solve();
  /// `first`: of the substep.
  /// `moved`: EnergyGuard::moved_velocity().
  void relax(bool first, PackedVector3<Real>* moved);
  /// Call after the iterations of relax. `motion`: without springs.
  void end_relax(LoopMotion<Real> motion) {
    motion.springs = spring_impulses();
    loops_.limit_energy(motion);
  }

  /// Errors and energy at the current state; waits for the device.
  JointSums measure();

  /// Impulses in scene order; waits for the device.
  std::vector<WarmStartJoint> save_warm_start() const;
  /// Call outside of runs. Joints that are not in `warm_start` start with zero impulse.
  void load_warm_start(const std::vector<WarmStartJoint>& warm_start);
  void visit_warm_start(const ArrayVisitor& visit) const {
    visit(impulses_.data(), impulses_.bytes());
    loops_.visit_allowances(visit);
  }
  void list_warm_start(HashedArrays& arrays) const {
    constexpr int numbers = 7;  // without padding
    if (impulses_.size() > 0)
      arrays.add<Real>(impulses_.data(), static_cast<std::int64_t>(impulses_.size()), numbers);
    loops_.list_allowances(arrays);
  }
  /// See LoopAllowance.
  std::vector<std::array<double, 2>> save_loop_energies() const { return loops_.save_allowances(); }
  void load_loop_energies(const std::vector<std::array<double, 2>>& energies) {
    loops_.load_allowances(energies);
  }

 private:
  JointRounds<Real> rounds(const BodyView<Real>& bodies) const;
  std::int64_t tree_count() const { return static_cast<std::int64_t>(trees_.count()); }
  JointTreeSolver<Real> tree_solver() const;
  void upload_trees(const InitialBodies& initial);
  void upload_springs(const std::vector<PlacedJoint>& joints, const std::vector<bool>& moves);
  /// Runs `StageWithRotation` with the effect rotation, otherwise `Stage`.
  template <class Stage, class StageWithRotation>
  void run(const BodyView<Real>& bodies);

  Executor& executor_;
  const BodyView<Real> bodies_;
  const Vector3<Real> gravity_;  ///< m/s^2
  StaticImpulse* const static_impulses_;
  const Real h_;
  const StepControl* control_;
  const std::uint8_t* asleep_ = nullptr;
  int colours_ = 0;
  std::int64_t max_joints_per_colour_ = 0;  ///< largest number of joints in a colour
  JointTrees trees_;                        ///< joints are indices in rows_
  std::vector<std::size_t> scene_order_;    ///< index in rows_ of each joint of the scene
  Buffer<JointRow<Real>> rows_;
  Buffer<JointImpulse<Real>> impulses_;
  Buffer<std::uint32_t> begin_;
  Buffer<TreeNode> nodes_;
  Buffer<std::uint32_t> tree_begin_;
  Buffer<double> tree_size_;
  Buffer<TreeNodeState> node_states_;
  Buffer<TreeClosing> closings_;
  Buffer<std::uint32_t> closing_begin_;
  Buffer<TreeClosingState> closing_states_;
  Buffer<TreeColumns> columns_;
  Buffer<TreeMember> members_;
  JointLoops<Real> loops_;
  Buffer<std::uint32_t> spring_bodies_;
  Buffer<PackedVector3<Real>> spring_impulse_, spring_moment_;
  Buffer<std::uint8_t> is_jointed_;
  Buffer<Pair> excluded_pairs_;
  Buffer<JointSums> sums_;
};

}  // namespace collidoscope
