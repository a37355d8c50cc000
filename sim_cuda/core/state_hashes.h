#pragma once
// Hashes of one state. Plain data.

#include <cstdint>

namespace collidoscope {

struct StateHashes {
  std::uint64_t bodies = 0;  ///< World::state_hash()
  std::uint64_t full = 0;    ///< of the whole state, with warm-start data; 0: unknown

  bool operator==(const StateHashes&) const = default;
};

}  // namespace collidoscope
