#pragma once
// Rolling resistance: what touches resists turning against each other, by at most
//
//   |M| <= c R N,  1/R = 1/R_a + 1/R_b (a plane: R = R_a),
//
// N the normal force: the law of Coulomb (1785), with the lever of the pressure as a share c of the radius.
// It works against the whole relative spin, so against drilling, too, by the same measure. Called for by a
// material whose `rolling_resistance` is not 0; c is 0 to 10, and a pair takes the larger of its two, for the
// softer one yields. Comes with friction, without which nothing rolls.
//
// Solved after friction whenever that is relaxed, implicitly and within c R times the normal impulse, and
// warm-started like it; pairs by mass splitting (Tonge et al. 2012), all at once, since no load rests on it;
// planes by each body itself. What a bounce adds to N is not counted. Owned by the solver; without the effect
// it has no memory.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/previous_contacts.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

/// The coefficients of what touches.
template <class Real>
struct RollingLaw {
  const Real* of_material = nullptr;        ///< 0 to 10, by material
  const std::uint16_t* material = nullptr;  ///< by body; null where all bodies are of material 0
  const Real* of_plane = nullptr;           ///< 0 to 10, as the planes

  SIM_HD Real of_body(std::uint32_t body) const {
    return of_material[material == nullptr ? 0 : material[body]];
  }
};

/// What one contact gives.
template <class Real>
struct alignas(4 * sizeof(Real)) RollingImpulse {
  Vector3<Real> impulse;  ///< N m s, given to b and taken from a; of the substep
  Real lever;             ///< m, c R
};

/// The contacts of a step and the planes, as the solver has them: by place in the order of sweeps.
template <class Real>
struct RollingSource {
  const Pair* contacts;
  const PackedContact<Real>* soft;
  const std::uint32_t* place_of;  ///< by contact number
  ContactsByBodyView by_body;
  ItemCount count;             ///< of contacts
  const Real* wall_impulse;    ///< N s, plane by plane, all bodies of each
  const std::uint8_t* asleep;  ///< by body; null where nothing sleeps
};

template <class Real>
class RollingResistance {
 public:
  explicit RollingResistance(Executor& executor);
  /// Once, where the effect is on.
  void enable(const BodyView<Real>& bodies, std::int64_t body_count, int plane_count,
              const RollingLaw<Real>& law, const StepControl* control);
  /// Outside of runs. `previous`, in contacts: of the run before; what is remembered stays.
  void reserve(std::int64_t contact_capacity, std::size_t previous);

  /// In each run, once its contacts are known: `previous` are those of the run before.
  void prepare(const RollingSource<Real>& source, const PreviousContacts& previous);
  /// In each substep, before any other impulse.
  void warm_start(const RollingSource<Real>& source);
  /// After friction.
  void solve(const RollingSource<Real>& source);
  /// At the end of a run.
  void keep(const RollingSource<Real>& source);

  /// As ContactSolver has them; `contacts` remembered ones.
  void save_warm_start(std::size_t contacts, WarmStart& warm_start) const;
  void load_warm_start(const WarmStart& warm_start, std::size_t contact_capacity);
  void visit_warm_start(std::size_t contacts, const ArrayVisitor& visit) const {
    if (control_ == nullptr) return;
    visit(previous_impulse_.data(), contacts * sizeof(Vector3<Real>));
    visit(wall_impulse_.data(), wall_impulse_.bytes());
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
  Buffer<Vector3<Real>> wall_impulse_;             ///< plane by plane, all bodies of each, N m s
  Buffer<Vector3<Real>> previous_impulse_;         ///< of the run before, by its contacts, N m s
};

}  // namespace collidoscope
