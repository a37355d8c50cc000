#pragma once
// Contact cache of `soft_step`: contacts of the last committed step with their impulses, for warm starting.
// Owned by the solver. A step that overflows leaves the cache unchanged.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/hashed_arrays.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/core/vector_load.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/previous_contacts.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

/// Stores the contacts and impulses of a step in the cache, for warm starting. Timed as the stage `keep`.
template <class Real>
struct StoreImpulses {
  const Pair* contacts;
  const std::uint32_t* place_of;
  const PackedContact<Real>* soft;
  const ContactSums<Real>* sums;
  Vector3<Real>* previous_friction;  ///< null without friction
  Real* total;                       ///< N s, per contact, over the step; null: not recorded
  Pair* previous_contacts;
  std::uint32_t* previous_first;
  Real* previous_impulse;
  SIM_HD void operator()(int contact) const {
    const auto number = static_cast<std::uint32_t>(contact);
    const std::uint32_t place = place_of[contact];
    const Pair ids = contacts[contact];
    previous_contacts[contact] = ids;
    if (PreviousContacts::is_first(contacts, number)) previous_first[ids.a] = number;
    const PackedContact<Real> kept = load_readonly(&soft[place]);
    previous_impulse[contact] = kept.impulse;
    if (previous_friction != nullptr)
      previous_friction[contact] =
          kept.impulse > 0 ? kept.friction_impulse : Vector3<Real>(Vector3<Real>::Zero());
    if (total != nullptr) total[contact] = sums[place].total;
  }
};

struct EndStep {
  const StepControl* control;
  std::uint32_t* count;
  SIM_HD void operator()(int) const {
    if (!control->overflow) *count = control->contacts;
  }
};

template <class Real>
class ContactCache {
 public:
  ContactCache(Executor& executor, std::int64_t body_count, bool with_friction);

  /// Sets the contact capacity of a step. Keeps the cached contacts.
  void reserve(std::int64_t contact_capacity);
  /// Capacity in contacts; at least the number passed to load().
  std::size_t capacity() const { return previous_contacts_.size(); }

  PreviousContacts view() const {
    return {previous_contacts_.data(), previous_count_.data(), previous_first_.data()};
  }
  const Real* impulse() const {
    return previous_impulse_.data();
  }  ///< N s, along the normal, by cached contact
  const Vector3<Real>* friction() const {
    return previous_friction_.data();
  }  ///< N s, by cached contact; null without friction
  /// The stage that fills the cache. `total`: see StoreImpulses::total.
  StoreImpulses<Real> store_stage(const Pair* contacts, const std::uint32_t* place_of,
                                  const PackedContact<Real>* soft, const ContactSums<Real>* sums,
                                  Real* total) const;
  std::uint32_t* count() const { return previous_count_.data(); }
  /// In the executor's memory.
  ItemCount items() const { return {previous_count_.data(), static_cast<std::int64_t>(capacity())}; }

  std::size_t size() const {
    return previous_count_.download()[0];
  }  ///< number of cached contacts; waits for the device
  void save(WarmStartParts& parts) const;
  void load(const WarmStart& warm_start);
  void visit(const ArrayVisitor& visit) const;
  void list(HashedArrays& arrays) const;

 private:
  const std::int64_t body_count_;
  const bool with_friction_;
  std::int64_t contact_capacity_ = 0;
  std::size_t loaded_ = 0;                   ///< number of contacts passed to load()
  Buffer<Pair> previous_contacts_;           ///< ordered by (a, b)
  Buffer<std::uint32_t> previous_first_;     ///< first contact of each body a
  Buffer<Real> previous_impulse_;            ///< N s
  Buffer<Vector3<Real>> previous_friction_;  ///< N s; empty without friction
  Buffer<std::uint32_t> previous_count_;     ///< one element
};

}  // namespace collidoscope
