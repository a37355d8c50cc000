#pragma once
// Rolling resistance: a contact resists the relative rotation of its bodies by a torque of at most
//
//   |M| <= c R N,  1/R = 1/R_a + 1/R_b (a plane: R = R_a),
//
// with the normal force N (Coulomb 1785). The lever is c times the radius. The torque acts against the
// whole relative angular velocity, rolling and drilling. Required if a material has a nonzero
// `rolling_resistance`. c is 0 to 10; a pair takes the larger of its two coefficients. Needs friction.
//
// Solved after each friction solve in relax, implicitly, limited by c R times the normal impulse, with warm
// starting. Body pairs use mass splitting (Tonge et al. 2012), all in parallel, since no load depends on
// them. Each body solves its own planes. Impulses of impacts (impact.h) are not part of N. Owned by the
// solver; without the effect it uses no memory.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/hashed_arrays.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/previous_contacts.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

/// Coefficients of materials and planes.
template <class Real>
struct RollingLaw {
  const Real* of_material = nullptr;        ///< by material, 0 to 10
  const std::uint16_t* material = nullptr;  ///< by body; null: all bodies have material 0
  const Real* of_plane = nullptr;           ///< by plane, 0 to 10

  SIM_HD Real of_body(std::uint32_t body) const {
    return of_material[material == nullptr ? 0 : material[body]];
  }
};

/// Rolling state of one contact.
template <class Real>
struct alignas(4 * sizeof(Real)) RollingImpulse {
  Vector3<Real> impulse;  ///< accumulated in the substep, N m s; applied to b, negative to a
  Real lever;             ///< c R, m
};

/// Contacts and planes of a step in solve order, from the solver.
template <class Real>
struct RollingSource {
  const Pair* contacts;
  const PackedContact<Real>* soft;
  const std::uint32_t* place_of;  ///< by contact number
  ContactsByBodyView by_body;
  ItemCount count;             ///< number of contacts
  const Real* wall_impulse;    ///< N s, index plane * body count + body
  const std::uint8_t* asleep;  ///< by body; null without the effect sleeping
};

template <class Real>
class RollingResistance {
 public:
  explicit RollingResistance(Executor& executor);
  /// Call once, if the effect is on.
  void enable(const BodyView<Real>& bodies, std::int64_t body_count, int plane_count,
              const RollingLaw<Real>& law, const StepControl* control);
  /// Call outside of runs. `previous`: capacity in contacts of the previous run. Keeps the warm-start data.
  void reserve(std::int64_t contact_capacity, std::size_t previous);

  /// Call in each run after contacts are found. `previous`: contacts of the previous run.
  void prepare(const RollingSource<Real>& source, const PreviousContacts& previous);
  /// Call in each substep, before any other impulse.
  void warm_start(const RollingSource<Real>& source);
  /// Call after each friction solve.
  void solve(const RollingSource<Real>& source);
  /// Call at the end of a run; stores the impulses for the next run.
  void store_impulses(const RollingSource<Real>& source);

  /// See ContactSolver. `contacts`: number of cached contacts.
  void save_warm_start(std::size_t contacts, WarmStartParts& parts) const;
  void load_warm_start(const WarmStart& warm_start, std::size_t contact_capacity);
  void visit_warm_start(std::size_t contacts, const ArrayVisitor& visit) const {
    if (control_ == nullptr) return;
    visit(previous_impulse_.data(), contacts * sizeof(Vector3<Real>));
    visit(wall_impulse_.data(), wall_impulse_.bytes());
  }
  void list_warm_start(const ItemCount& contacts, HashedArrays& arrays) const {
    if (control_ == nullptr) return;
    arrays.add<Real>(previous_impulse_.data(), contacts);
    if (wall_impulse_.size() > 0)
      arrays.add<Real>(wall_impulse_.data(), static_cast<std::int64_t>(wall_impulse_.size()));
  }

 private:
  Executor& executor_;
  BodyView<Real> bodies_{};
  std::int64_t body_count_ = 0;
  int plane_count_ = 0;
  RollingLaw<Real> law_;
  const StepControl* control_ = nullptr;
  Buffer<RollingImpulse<Real>> rolling_impulses_;  ///< by place
  Buffer<Vector3<Real>> change_;                   ///< by place, N m s
  Buffer<Vector3<Real>> wall_impulse_;             ///< N m s, index plane * body count + body
  Buffer<Vector3<Real>> previous_impulse_;         ///< by contact of the previous run, N m s
};

}  // namespace collidoscope
