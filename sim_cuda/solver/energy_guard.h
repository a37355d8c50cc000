#pragma once
// Limits the energy that the contact solver may add. Few iterations do not solve a contact problem exactly:
// warm starting and overlap recovery can add kinetic energy, most of all under heavy loads and with deep
// overlap at the start.
//
// In a substep, contacts change the velocity w + h g of a body (w: after drag; g: gravity and attractors) by
// d, with angular velocities included below. The total energy of bodies that move by h times their new
// velocity rises by
//
//   G = sum of m (w . d + d . d / 2) - m h^2 g . g / 2
//
// A body with unequal moments of inertia also turns between the impulses before and after the move, which
// changes the energy of its angular momentum L: G has the further term E(q', L) - E(q, L), with its
// orientations q, q' at the start and the end, and L at the start. It is 0 in free rotation.
//
// An exact inelastic solution has G <= 0. If G > 0 in an island, the share s of all contact impulses P at the
// end of the substep is removed from the velocities, so that the energy does not rise:
//
//   G - s S + s^2 D / 2 = 0,  S = sum of (w + d) . P,  D = sum of P . P / m
//
// If energy is still gained then, an island that touches planes or static bodies has all velocity changes d
// scaled by the factor f with G(f d) = 0. In other islands, this would change the angular momentum. They gain
// energy because normals turn while bodies recover from deep overlap, and impulses are removed that oppose
// the relative normal velocities of all contacts that have pressed in the step. Each such removal is a step
// of steepest descent; there are at most four. The last removal takes a share of the motion relative to the
// rigid motion of the island (rigid_motion.h). An island at rest that recovers from overlap ends at rest. If
// the island touches planes or static bodies, the last removal takes a share of the motion itself.
//
// Impulses act along the normals at the current positions, so momentum and angular momentum are conserved. So
// does the last removal. Bodies that moved freely have no term m h^2 g . g / 2, because free flight is exact.
//
// The impulses for warm starting (loads) keep the removed share: at rest, a load that is reduced would be
// missing in the next substep. An island that is stopped has loads of its deceleration. They are too large,
// and would lift it in every substep: its velocities are limited after the move, so nothing else would end
// this. So with gravity or attractors, the loads of an island that gains energy are multiplied by the factor
// f in [0.65, 1] that leaves the least kinetic energy in the next substep, in which a body without loads
// would have the velocity 2 v - w - P / m:
//
//   f = 1 + s - sum of (2 v - w) . P / D
//
// With friction, loads of slow islands are reduced less (GuardRounds::full_motion). Without friction, tall
// piles rest with the full factor. Without gravity, loads come from overlap only, and bodies that start with
// one centre would separate more slowly.
//
// An island is a set of dynamic bodies that are connected by contacts that have pressed in the step, or by
// joints. The sets only grow within a step, so a substep starts with those of the last one. Springs are
// forces like gravity: their impulses S are not part of d; they do the work S . (w + v) / 2, where v is the
// velocity at the end. Islands are found only in substeps in which G of the whole scene is positive, within a
// tolerance: an island can gain energy while others lose more. Bodies with springs only are exempt: the
// energy of a spring varies within a period, and a limit from one side would damp it. Groups of joints are
// exempt while they touch nothing; then they conserve energy (joint_tree_solver.h) or have a limit of their
// own (joint_loops.h). Islands with contacts to moving kinematic bodies are exempt, because these do work on
// bodies.
//
// Sums per island are sums of 64-bit integers, in units of the island's largest term, so that they do not
// depend on the order. All stages are rounds of one launch.
//
// Also adds StaticImpulse::push_work, the potential energy that overlap recovery adds: -m g . (h v_moved -
// h v), where v_moved is the velocity of the move and v the velocity at the end of the substep. Not for
// bodies that are exempt because of joints, whose constraints also change the velocity after the move.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/solver/contact_solver.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/energy_terms.h"

namespace collidoscope {

/// Contacts at the end of a substep.
template <class Real>
struct GuardedContacts {
  const Pair* ids;  ///< by place, as the next two
  PackedContact<Real>* soft;
  const ContactSums<Real>* sums;
  Real* opposing;                        ///< N s; memory for one impulse per place
  ContactsByBodyView by_body;            ///< places of all contacts
  Real* plane_impulse;                   ///< N s; index surface * body count + body
  const Vector3<Real>* plane_friction;   ///< N s; null without friction
  const ContactPlane<Real>* box_planes;  ///< contact planes of boxes; index box * body count + body
  const std::uint8_t* stopped;           ///< by body, see SoftWalls; null without surfaces
  const std::uint8_t* asleep;            ///< by body, or null
};

/// Impulses of the contacts of a body, as they act at the current positions.
template <class Real>
struct ContactChange {
  Vector3<Real> impulse, moment;  ///< N s, N m s
};

template <class Real>
class EnergyGuard {
 public:
  EnergyGuard(Executor& executor, const SolverScene<Real>& scene);

  /// By body, written by the first stage of the substep: velocity after drag and before gravity, m/s, and
  /// AngularState::spin(); the latter is null if contacts and joints do not change it.
  PackedVector3<Real>* start_velocity() { return start_velocity_.data(); }
  PackedVector3<Real>* start_spin() { return start_spin_.size() > 0 ? start_spin_.data() : nullptr; }
  /// By body, of the same time: kinetic energy of the rotation, J. Null if all moments of inertia are equal.
  Real* start_rotation() { return start_rotation_.size() > 0 ? start_rotation_.data() : nullptr; }
  /// Velocities of the move, m/s, by body; written by the integrator.
  PackedVector3<Real>* moved_velocity() { return moved_velocity_.data(); }
  /// By body, written by the integrator: 1 if the body moved freely. Null with semi-implicit Euler.
  std::uint8_t* is_free() { return is_free_.size() > 0 ? is_free_.data() : nullptr; }

  /// Largest number of removals, and number of partial sums of the scene's G.
  static constexpr int removals = 6, total_slots = 64;

  /// Call at the end of each substep of `h` s. `contacts`: at most `contact_capacity`.
  void apply(Real h, bool is_first_substep, const GuardedContacts<Real>& contacts,
             std::int64_t contact_capacity);

 private:
  Executor& executor_;
  const SolverScene<Real> scene_;
  Buffer<PackedVector3<Real>> start_velocity_, start_spin_;
  Buffer<Real> start_rotation_;
  Buffer<PackedVector3<Real>> moved_velocity_;
  Buffer<double> gains_;           ///< by body, see GuardRounds
  Buffer<std::uint32_t> largest_;  ///< see GuardRounds
  Buffer<std::uint64_t> total_;    ///< see GuardRounds
  Buffer<std::uint32_t> flags_;    ///< see GuardRounds::flags
  Buffer<std::uint32_t> parent_;   ///< by body
  Buffer<std::uint32_t> scale_;    ///< by root: bits of the largest term, J (float)
  Buffer<EnergyTerms> terms_;      ///< by body
  Buffer<ContactChange<Real>> changes_;
  Buffer<std::uint64_t> sums_;         ///< by root: see EnergyTerms
  Buffer<std::uint8_t> exempt_;        ///< by body: it has a joint, or touches a moving kinematic body
  Buffer<std::uint8_t> grounded_;      ///< by body: it touches a plane or a static body
  Buffer<std::uint8_t> active_;        ///< by body: see GuardRounds
  Buffer<std::uint32_t> rigid_scale_;  ///< see GuardRounds
  Buffer<std::uint64_t> rigid_sums_;   ///< see GuardRounds
  Buffer<float> load_factor_;          ///< see GuardRounds; may be empty
  Buffer<std::uint8_t> is_free_;       ///< by body; empty with Euler's integrator
};

}  // namespace collidoscope
