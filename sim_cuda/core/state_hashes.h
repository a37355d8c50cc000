#pragma once
// Hashes of one state. Plain data.

#include <cstdint>

#include "sim_cuda/core/hash.h"

namespace collidoscope {

struct StateHashes {
  std::uint64_t bodies = 0;  ///< World::state_hash()
  std::uint64_t full = 0;    ///< of the whole state, with warm-start data; 0: unknown

  bool operator==(const StateHashes&) const = default;

  /// `sums`: of hashes of bodies, and of other data (StepControl).
  static StateHashes of(const std::uint64_t (&sums)[2]) {
    const std::uint64_t full = mix64(sums[0] ^ mix64(sums[1]));
    return {sums[0], full != 0 ? full : 1};
  }
};

}  // namespace collidoscope
