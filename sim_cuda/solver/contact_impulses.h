#pragma once
// The normal impulses of contacts, in a list that belongs to a list of contacts: what a step gave, kept for
// whoever draws forces (and, one day, starts the next solve from them). Off, it has no memory, and solvers
// are compiled without it.
//
// A solver adds to data()[i] for contact i of the run in progress. What is drawn are contacts of another
// list, that of the state the run led to: keep() puts impulses aside with the contacts they belong to, and
// view() finds them again by their bodies.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"

namespace collidoscope {

/// A list of contacts, ordered by (a, b), and their impulses, in the executor's memory.
template <class Real>
struct ImpulseView {
  const Pair* contacts = nullptr;
  const Real* impulse = nullptr;         ///< N s, >= 0
  const std::uint32_t* count = nullptr;  ///< null: none are known

  /// Where a pair stands in the list, or `no_pair`.
  SIM_HD std::uint32_t find(std::uint32_t a, std::uint32_t b) const {
    return count == nullptr ? no_pair : find_pair(contacts, 0, *count, a, b);
  }
  /// 0 for a pair that the list lacks.
  SIM_HD Real of(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t place = find(a, b);
    return place == no_pair ? Real(0) : impulse[place];
  }
};

/// Adds up the impulse of each contact, where that is recorded.
template <class Real>
struct ImpulseSum {
  Real* impulse;  ///< N s; null: nothing is recorded
  SIM_HD void add(std::uint32_t contact, Real more) const {
    if (impulse != nullptr) impulse[contact] += more;
  }
};

template <class Real>
class ContactImpulses {
 public:
  explicit ContactImpulses(Executor& executor);

  /// All that follows is outside of steps. Off gives all memory back.
  void enable(bool on);
  bool enabled() const { return enabled_; }
  /// `capacity` in contacts.
  void reserve(std::int64_t capacity);

  /// One for each contact of the run in progress, N s; null while off.
  Real* data() const { return impulse_.data(); }
  /// Puts data() aside, for control->contacts contacts.
  void keep(const Pair* contacts, const StepControl* control);
  /// What was kept last.
  ImpulseView<Real> view() const;

 private:
  Executor& executor_;
  bool enabled_ = false;
  std::int64_t capacity_ = 0;
  Buffer<Real> impulse_;
  Buffer<Pair> kept_contacts_;
  Buffer<Real> kept_impulse_;
  Buffer<std::uint32_t> kept_count_;  ///< one; empty: nothing was kept yet
};

}  // namespace collidoscope
