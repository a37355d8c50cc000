#pragma once
// The ordered list of contacts: pairs whose shapes touch, or may touch soon. Same order as the pairs (by a,
// then b). Owns the list, in the executor's memory.

#include <cstdint>

#include "sim_cuda/broad_phase/pair_list.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"

namespace collidoscope {

template <class Real>
struct ContactView {
  const Pair* bodies;           ///< a < b
  const Vector3<Real>* normal;  ///< unit, from a to b
};

/// Positions and radii of the colliding spheres, by body id.
template <class Real>
struct SphereView {
  const Vector3<Real>* position;  ///< m
  const Real* radius;             ///< m
  /// 1/kg; null if all bodies are dynamic. Two bodies of 0 have no contact.
  const Real* inverse_mass = nullptr;
};

/// Pairs without contacts, because a joint connects them. Ordered; in the executor's memory.
struct ExcludedPairs {
  const Pair* pairs = nullptr;
  std::uint32_t count = 0;

  SIM_HD bool contains(std::uint32_t a, std::uint32_t b) const {
    return find_pair(pairs, 0, count, a, b) != no_pair;
  }
};

template <class Real>
class ContactList {
 public:
  explicit ContactList(Executor& executor);
  /// Call outside the step. `capacity` in contacts.
  void reserve(std::int64_t bodies, std::int64_t capacity);
  std::int64_t capacity() const { return static_cast<std::int64_t>(bodies_of_.size()); }
  /// Tests all pairs except the excluded ones. Pairs that may touch within `margin` are contacts, too. If the
  /// capacity is too small, sets control->overflow and contacts_needed, and leaves the list empty, as
  /// PairList::find() does.
  void find(const PairView& pairs, const SphereView<Real>& spheres, const SpeculativeMargin<Real>& margin,
            const ExcludedPairs& excluded_pairs, StepControl* control);
  ContactView<Real> view() const { return {bodies_of_.data(), normal_.data()}; }

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0;
  Buffer<std::uint32_t> count_;
  Buffer<std::uint32_t> offset_;
  Buffer<Pair> bodies_of_;
  Buffer<Vector3<Real>> normal_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope
