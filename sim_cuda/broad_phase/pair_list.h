#pragma once
// The ordered list of pairs: found in any order and counted per body, placed by a scan, and sorted within
// each body's own segment. No total is needed on the host, and the list is the same whatever method found the
// pairs.

#include <cstdint>

#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"

namespace collidoscope {

/// The list in the executor's memory: pairs of body a are (a, second[k]) for k in offset[a] .. offset[a+1]-1,
/// ascending.
struct PairView {
  const std::uint32_t* offset;  ///< bodies + 1
  const std::uint32_t* second;
};

class PairList {
 public:
  explicit PairList(Executor& executor);
  /// Outside the step. `capacity` in pairs, < 2^31.
  void reserve(std::int64_t bodies, std::int64_t capacity);
  std::int64_t capacity() const { return static_cast<std::int64_t>(second_.size()); }
  /// Fills the list from a broad phase that has its boxes. Where the capacity is too small: sets
  /// control->overflow and leaves the list empty (control->pairs = 0), with control->pairs_needed saying what
  /// it takes.
  void find(BroadPhase& method, StepControl* control);
  PairView view() const { return {offset_.data(), second_.data()}; }

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0;
  Buffer<FoundPair> found_;      ///< in order of arrival
  Buffer<std::uint32_t> count_;  ///< {their number, in 64 bits, then of each body}: cleared together
  Buffer<std::uint32_t> offset_;
  Buffer<std::uint32_t> second_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope
