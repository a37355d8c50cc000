#pragma once
// The ordered list of contacts: the pairs whose shapes touch, in the order of the pairs (by a, then b).

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

/// Positions and radii of what collides, by id.
template <class Real>
struct SphereView {
  const Vector3<Real>* position;       ///< m
  const Real* radius;                  ///< m
  const Real* inverse_mass = nullptr;  ///< 1/kg; null where every body can be moved. Two of 0 do not touch
};

/// Pairs that never touch, whatever their shapes, since a joint holds them: ordered, in the executor's
/// memory.
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
  /// Outside the step. `capacity` in contacts.
  void reserve(std::int64_t bodies, std::int64_t capacity);
  std::int64_t capacity() const { return static_cast<std::int64_t>(bodies_of_.size()); }
  /// Tests all pairs but the excluded ones; those count as well that may touch within `margin`. Where the
  /// capacity is too small: control->overflow, contacts_needed, and an empty list, as for pairs.
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
