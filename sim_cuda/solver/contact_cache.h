#pragma once
// The contact cache of `soft_step`: the contacts of the last committed step and their impulses, from which
// the next step starts (warm starting). An overflow leaves it as it is.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/aside.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/core/whole_record.h"
#include "sim_cuda/solver/known_contacts.h"
#include "sim_cuda/solver/soft_memory.h"
#include "sim_cuda/solver/solver_memory.h"

namespace collidoscope {

/// What the next run starts from.
template <class Real>
struct KeepContacts {
  const Pair* contacts;
  const std::uint32_t* place_of;
  const StoredContact<Real>* soft;
  const ContactSums<Real>* sums;
  Vector3<Real>* known_grip;  ///< null without friction
  Real* total;                ///< N s, of the step; null: not recorded
  Pair* known_contacts;
  std::uint32_t* known_first;
  Real* known_impulse;
  SIM_HD void operator()(int contact) const {
    const auto number = static_cast<std::uint32_t>(contact);
    const std::uint32_t place = place_of[contact];
    const Pair ids = contacts[contact];
    known_contacts[contact] = ids;
    if (KnownContacts::is_first(contacts, number)) known_first[ids.a] = number;
    const StoredContact<Real> kept = load_whole(&soft[place]);
    known_impulse[contact] = kept.impulse;
    if (known_grip != nullptr)
      known_grip[contact] = kept.impulse > 0 ? kept.rubbed : Vector3<Real>(Vector3<Real>::Zero());
    if (total != nullptr) total[contact] = sums[place].total;
  }
};

struct EndStep {
  const StepControl* control;
  std::uint32_t *count, *bounces;
  SIM_HD void operator()(int) const {
    if (!control->overflow) *count = control->contacts;
    *bounces = 0;
  }
};

template <class Real>
class ContactCache {
 public:
  ContactCache(Executor& executor, std::int64_t body_count, bool with_friction);

  /// `contact_capacity`: of the step. Keeps what is there.
  void reserve(std::int64_t contact_capacity);
  /// In contacts; at least what load() was given.
  std::size_t capacity() const { return known_contacts_.size(); }

  KnownContacts view() const { return {known_contacts_.data(), known_count_.data(), known_first_.data()}; }
  const Real* impulse() const { return known_impulse_.data(); }         ///< N s, along the normal
  const Vector3<Real>* friction() const { return known_grip_.data(); }  ///< N s; null without friction
  /// The stage that fills it. `total`: as KeepContacts::total.
  KeepContacts<Real> keeping(const Pair* contacts, const std::uint32_t* place_of,
                             const StoredContact<Real>* soft, const ContactSums<Real>* sums,
                             Real* total) const;
  std::uint32_t* count() const { return known_count_.data(); }

  std::size_t size() const { return known_count_.download()[0]; }  ///< waits for the device
  void save(SolverMemory& memory) const;
  void load(const SolverMemory& memory);
  void visit(const ArrayVisit& visit) const;

 private:
  const std::int64_t body_count_;
  const bool with_friction_;
  std::int64_t contact_capacity_ = 0;
  std::size_t loaded_ = 0;             ///< contacts that load() was given
  Buffer<Pair> known_contacts_;        ///< ordered by (a, b)
  Buffer<std::uint32_t> known_first_;  ///< of each body a, the first
  Buffer<Real> known_impulse_;         ///< N s
  Buffer<Vector3<Real>> known_grip_;   ///< N s; empty without friction
  Buffer<std::uint32_t> known_count_;  ///< one
};

}  // namespace collidoscope
