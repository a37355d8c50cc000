#pragma once
// The impacts at the start of each substep (impact.h, impact_sweeps.h), timed as the stage `bounce`. Owns the
// marks and lists of its sweeps.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/solver/contact_solver.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/plane_contacts.h"
#include "sim_cuda/solver/soft_contact.h"
#include "sim_cuda/solver/soft_iteration.h"

namespace collidoscope {

template <class Real>
class ImpactStage {
 public:
  ImpactStage(Executor& executor, const SolverScene<Real>& scene);
  void reserve(std::int64_t contact_capacity);

  /// Resolves impacts that happen in the substep, with friction. `by_body`: places of all contacts. `asleep`:
  /// by body, or null. `chain_counts`: ChainView::count, which becomes 0; or null. Precondition: the field of
  /// attractors is that of the current positions.
  template <bool with_friction>
  void resolve(const OrderedContacts<Real, with_friction>& contacts, const PlaneContacts<Real>& planes,
               const ContactsByBodyView& by_body, const std::uint8_t* asleep, std::uint32_t* chain_counts);

  /// By body, until the next substep: 0: slow, 1: fast, 2 and more: has had an impact.
  const std::uint8_t* struck() const { return struck_.data(); }
  /// 0: no body is fast or has had an impact.
  const std::uint32_t* any_moving() const;

 private:
  Executor& executor_;
  const SolverScene<Real> scene_;
  const Real h_;  ///< substep, s
  std::int64_t contact_capacity_ = 0;
  Buffer<std::uint32_t> needed_;                   ///< see ImpactSweeps::needed
  Buffer<std::uint8_t> struck_, struck_contacts_;  ///< see StruckMarks
  Buffer<std::uint8_t> driven_, supported_;        ///< see ShockMarks
  /// See LastSweepLists; empty on the CPU.
  Buffer<std::uint32_t> last_sizes_, last_bodies_, last_next_, last_places_, last_listed_;
};

}  // namespace collidoscope
