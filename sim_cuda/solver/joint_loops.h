#pragma once
// Bodies with iterated joints, in groups: sets of bodies that rigid joints connect and that contain a loop
// (scene/joint_trees.h). Owned by Joints.
//
// Position errors: solve and relax of joint_constraint.h only act on velocity errors. JointPhase::correct
// computes separate velocities that remove position errors. They are added for the move and removed after it,
// so they add no kinetic energy. The potential energy that they add is push_work.
//
// Energy: iterations do not solve a loop exactly, and forces act at the start of a substep. A taut net gains
// energy then (Tournier et al. 2015). Let G be the energy that joints and rounding add in a substep:
//
//   G = sum of m (v . v - w . w) / 2 - m h g . u - P . (w + v) / 2,
//
// w and v: velocity at the start and the end; u: velocity of the move, without the correction; P: impulses of
// springs. Angular velocities are included. The sum of G varies within a period of a swinging joint. It may
// rise above its earlier minimum by `bound` of the largest kinetic energy so far. A group that rises more is
// slowed down. If it is joined to the world or a static body, all velocities are scaled, which keeps
// the joints satisfied; if not, the velocities relative to the rigid motion of the group, which also
// conserves momentum and angular momentum. Groups that touch something are left to the energy guard
// (energy_guard.h), and those joined to a moving kinematic body are not limited.

#include <array>
#include <cstdint>
#include <vector>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/hashed_arrays.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/scene/joint_trees.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/rigid_motion.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

/// Impulses of the last substep on each body, by contacts and static surfaces.
template <class Real>
struct ImpulsesByBody {
  const PackedContact<Real>* contacts;
  ContactsByBodyView by_body;
  const Real* surface_impulse;  ///< N s; index surface * body count + body
  int surfaces;
  std::int64_t body_count;

  /// True if something presses on the body.
  SIM_HD bool touches(int body, const StepControl& control) const {
    for (int surface = 0; surface < surfaces; ++surface)
      if (surface_impulse[surface * body_count + body] > 0) return true;
    if (control.contacts == 0) return false;
    for (std::uint32_t k = 0; k < by_body.count[body]; ++k)
      if (contacts[by_body.end(body, k).contact].impulse > 0) return true;
    return false;
  }
};

/// Energy that a group may still gain, and its largest kinetic energy so far, J.
struct LoopAllowance {
  double left = 0, largest = 0;
};

/// Sums of the impulses of springs in a substep, which the energy guards need.
template <class Real>
struct SpringImpulses {
  PackedVector3<Real>*impulse = nullptr, *moment = nullptr;  ///< N s, N m s, by body; null if not needed
  /// Change of the velocity, m/s, and of the angular velocity, rad/s.
  SIM_HD Vector3<Real> change(const BodyView<Real>& bodies, int body) const {
    if (impulse == nullptr) return Vector3<Real>::Zero();
    return bodies.inverse_mass[body] * impulse[body].load();
  }
  SIM_HD Vector3<Real> spin_change(const BodyView<Real>& bodies, int body) const {
    if (impulse == nullptr) return Vector3<Real>::Zero();
    AngularState<Real> angular = AngularState<Real>::of(bodies, static_cast<std::uint32_t>(body));
    angular.velocity = Vector3<Real>::Zero();
    angular.apply_angular_impulse(moment[body].load());
    return angular.velocity;
  }
  SIM_HD void add(std::uint32_t body, const Vector3<Real>& by, const Vector3<Real>& arm) const {
    impulse[body] = Vector3<Real>(impulse[body].load() + by);
    moment[body] = Vector3<Real>(moment[body].load() + arm.cross(by));
  }
};

/// Bodies of one group that one item sums.
struct LoopChunk {
  static constexpr std::uint32_t size = 16;
  std::uint32_t begin, end;  ///< places in LoopView::bodies
};

/// Result of a substep for a group: v becomes c + s (v - c), where c is the velocity of the rigid motion.
struct LoopScaling {
  double scale = 1;
  RigidMotion rigid;
};

template <class Real>
struct LoopView {
  const std::uint32_t* bodies = nullptr;       ///< group by group
  const std::uint32_t* group_of = nullptr;     ///< by body; JointLoopGroups::none without a group
  const LoopChunk* chunks = nullptr;           ///< group by group
  const std::uint32_t* chunk_begin = nullptr;  ///< by group, and the end
  const std::uint32_t* supports = nullptr;     ///< bodies that do not respond, or the world, group by group
  const std::uint32_t* support_begin = nullptr;
  std::uint32_t* touches = nullptr;                                      ///< by group: 1 if it touches
  PackedVector3<Real>*correction = nullptr, *spin_correction = nullptr;  ///< by body
  PackedVector3<Real>* start_spin = nullptr;  ///< rad/s, by body; null without rotation
  double* start_energy = nullptr;             ///< J, by body: of rotation
  double* sums = nullptr;                     ///< J, by chunk: G, kinetic energy
  LoopAllowance* allowances = nullptr;        ///< by group
  LoopScaling* scalings = nullptr;            ///< by group
  std::uint32_t body_count = 0, chunk_count = 0, group_count = 0;

  SIM_HD bool has(int body) const { return group_count > 0 && group_of[body] != JointLoopGroups::none; }
  SIM_HD bool is_touching(int body) const { return has(body) && touches[group_of[body]] != 0; }
};

/// Velocities that limit_energy() needs, by body.
template <class Real>
struct LoopMotion {
  const PackedVector3<Real>* start;  ///< m/s, after drag and before gravity
  const PackedVector3<Real>* moved;  ///< m/s, of the move
  const Vector3<Real>* field;        ///< m/s^2; null without attractors
  const std::uint8_t* asleep;        ///< or null
  SpringImpulses<Real> springs;
};

template <class Real>
class JointLoops {
 public:
  /// Part of the largest kinetic energy by which the energy of a group may rise.
  static constexpr double bound = 2e-3;

  JointLoops(Executor& executor, const BodyView<Real>& bodies, const Vector3<Real>& gravity,
             StaticImpulse* static_impulses, Real h, const StepControl* control);
  void upload(const JointLoopGroups& groups, std::size_t body_count);
  /// Memory for the corrections of all bodies, also without groups.
  void reserve_corrections(std::size_t body_count);

  bool empty() const { return bodies_.size() == 0; }
  LoopView<Real> view() const;
  /// The bodies, with the corrections as velocities.
  BodyView<Real> corrections() const;

  // Call once per substep each, in this order.
  void begin(const ImpulsesByBody<Real>& impulses);
  void add_corrections();
  void remove_corrections();
  void limit_energy(const LoopMotion<Real>& motion);

  std::vector<std::array<double, 2>> save_allowances() const;
  /// Without effect if the number of groups differs.
  void load_allowances(const std::vector<std::array<double, 2>>& allowances);
  void visit_allowances(const ArrayVisitor& visit) const {
    if (!empty()) visit(allowances_.data(), allowances_.bytes());
  }
  void list_allowances(HashedArrays& arrays) const {
    if (!empty()) arrays.add<double>(allowances_.data(), static_cast<std::int64_t>(allowances_.size()));
  }

 private:
  Executor& executor_;
  const BodyView<Real> body_view_;
  const Vector3<Real> gravity_;
  StaticImpulse* const static_impulses_;
  const Real h_;
  const StepControl* const control_;
  Buffer<std::uint32_t> bodies_, group_of_, chunk_begin_, supports_, support_begin_, touches_;
  Buffer<LoopChunk> chunks_;
  Buffer<PackedVector3<Real>> correction_, spin_correction_, start_spin_;
  Buffer<double> start_energy_, sums_;
  Buffer<LoopAllowance> allowances_;
  Buffer<LoopScaling> scalings_;
};

}  // namespace collidoscope
