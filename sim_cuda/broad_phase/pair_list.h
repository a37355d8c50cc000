#pragma once
// The ordered list of pairs. Pairs are found in any order and counted per body, placed by a scan, and sorted
// within each body's segment. The host does not need the total. The list does not depend on the broad phase
// method. Owns the list, in the executor's memory.

#include <cstdint>

#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"

namespace collidoscope {

/// The list in the executor's memory. The pairs of body a are (a, second[k]) for k in offset[a] ..
/// offset[a+1]-1, ascending.
struct PairView {
  const std::uint32_t* offset;  ///< bodies + 1 elements
  const std::uint32_t* second;
};

class PairList {
 public:
  explicit PairList(Executor& executor);
  /// Call outside the step. `capacity` in pairs, < 2^31.
  void reserve(std::int64_t bodies, std::int64_t capacity);
  std::int64_t capacity() const { return static_cast<std::int64_t>(second_.size()); }
  /// Fills the list from a broad phase that has been updated. If the capacity is too small, sets
  /// control->overflow and control->pairs_needed, and leaves the list empty (control->pairs = 0).
  void find(BroadPhase& method, StepControl* control);
  PairView view() const { return {offset_.data(), second_.data()}; }

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0;
  Buffer<FoundPair> found_;      ///< unordered
  Buffer<std::uint32_t> count_;  ///< {total number of pairs, in 64 bits; pairs per body}: cleared together
  Buffer<std::uint32_t> offset_;
  Buffer<std::uint32_t> second_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope
