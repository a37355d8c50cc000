#pragma once
// The joints of a scene, and how `soft_step` iterates over them: colour by colour, where colours are shared
// out once, first fit in the order of the scene; what nothing moves, the world among it, is of every colour.
// Made with the pipeline and as long-lived; each iteration is one call of the executor. An overflow leaves
// all as it is.

#include <cstdint>
#include <utility>
#include <vector>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/scene/placed_joint.h"
#include "sim_cuda/solver/joint_measure.h"
#include "sim_cuda/solver/joint_state.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

template <class Real>
struct JointRounds;

template <class Real>
class Joints {
 public:
  /// `h`: s, of a substep. `control` and what `bodies` points to stay.
  Joints(Executor& executor, const std::vector<PlacedJoint>& joints, const InitialBodies& initial,
         const BodyView<Real>& bodies, Real h, const StepControl* control);

  std::int64_t count() const { return static_cast<std::int64_t>(rows_.size()); }
  int colours() const { return colours_; }
  JointView<Real> view() const { return {rows_.data(), impulses_.data(), begin_.data(), count()}; }

  /// Those whose bodies do not touch each other.
  ExcludedPairs excluded_pairs() const {
    return {excluded_pairs_.data(), static_cast<std::uint32_t>(excluded_pairs_.size())};
  }

  /// Joints of bodies that are asleep, 1 by body, are left as they are from now on.
  void exclude_sleeping(const std::uint8_t* asleep) { asleep_ = asleep; }

  // In each substep, in this order, with bodies that move between solve and relax.
  void warm_start();
  void solve();
  void relax();

  /// What joints say of the current state; waits for the device.
  JointSums measure();

  /// By the scene's order; waits for the device.
  std::vector<WarmStartJoint> save_warm_start() const;
  /// Outside of runs. Joints that `warm_start` does not know start from nothing.
  void load_warm_start(const std::vector<WarmStartJoint>& warm_start);
  void visit_warm_start(const ArrayVisitor& visit) const { visit(impulses_.data(), impulses_.bytes()); }

 private:
  JointRounds<Real> rounds() const;
  /// `StageWithRotation` where bodies turn, else `Stage`.
  template <class Stage, class StageWithRotation>
  void run();

  Executor& executor_;
  const BodyView<Real> bodies_;
  const Real h_;
  const StepControl* control_;
  const std::uint8_t* asleep_ = nullptr;
  int colours_ = 0;
  std::int64_t max_joints_per_colour_ = 0;  ///< joints of one colour
  std::vector<std::size_t> scene_order_;    ///< where each joint of the scene stands
  Buffer<JointRow<Real>> rows_;
  Buffer<JointImpulse<Real>> impulses_;
  Buffer<std::uint32_t> begin_;
  Buffer<Pair> excluded_pairs_;
  Buffer<JointSums> sums_;
};

}  // namespace collidoscope
