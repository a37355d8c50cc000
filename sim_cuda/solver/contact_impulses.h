#pragma once
// Optional per-contact normal impulses for display. Allocates nothing when disabled. Lives as long as the
// pipeline.
//
// A solver adds to data()[i] for contact i of the run in progress. The displayed contacts are those of the
// resulting state, which is another list. keep() copies the impulses with their contacts, and view() looks
// them up by body pair.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"

namespace collidoscope {

/// Contacts ordered by (a, b) with their impulses, in the executor's memory.
template <class Real>
struct ImpulseView {
  const Pair* contacts = nullptr;
  const Real* impulse = nullptr;         ///< N s, >= 0
  const std::uint32_t* count = nullptr;  ///< one element; null: no impulses recorded

  /// Index of a pair in the list, or `no_pair`.
  SIM_HD std::uint32_t find(std::uint32_t a, std::uint32_t b) const {
    return count == nullptr ? no_pair : find_pair(contacts, 0, *count, a, b);
  }
  /// Impulse of a pair, N s; 0 if the pair is not in the list.
  SIM_HD Real of(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t place = find(a, b);
    return place == no_pair ? Real(0) : impulse[place];
  }
};

/// Accumulates contact impulses; does nothing if recording is off.
template <class Real>
struct ImpulseSum {
  Real* impulse;  ///< N s, by contact; null: recording is off
  SIM_HD void add(std::uint32_t contact, Real more) const {
    if (impulse != nullptr) impulse[contact] += more;
  }
};

template <class Real>
class ContactImpulses {
 public:
  explicit ContactImpulses(Executor& executor);

  /// Call all functions below outside of steps. Disabling releases the memory.
  void enable(bool on);
  bool enabled() const { return enabled_; }
  /// Sets the capacity in contacts.
  void reserve(std::int64_t capacity);

  /// Impulse per contact of the run in progress, N s; null if disabled.
  Real* data() const { return impulse_.data(); }
  /// Copies data() and its contacts; their number is control->contacts.
  void keep(const Pair* contacts, const StepControl* control);
  /// The impulses of the last keep().
  ImpulseView<Real> view() const;

 private:
  Executor& executor_;
  bool enabled_ = false;
  std::int64_t capacity_ = 0;
  Buffer<Real> impulse_;
  Buffer<Pair> kept_contacts_;
  Buffer<Real> kept_impulse_;
  Buffer<std::uint32_t> kept_count_;  ///< one element; empty before the first keep()
};

}  // namespace collidoscope
