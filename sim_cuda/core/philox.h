#pragma once
// Philox4x32-10, a counter-based random number generator (Salmon et al., "Parallel random numbers: as easy as
// 1, 2, 3", 2011). 128 random bits are a pure function of a 64-bit key and a 128-bit counter. There is no
// state, so bodies can be generated independently, in any order, with the same result.

#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Four 32-bit words: a counter as input, random bits as output.
struct PhiloxWords {
  std::uint32_t w[4];
};

struct PhiloxKey {
  std::uint32_t k[2];
};

/// Converts a 64-bit seed to a key, low word first.
SIM_HD constexpr PhiloxKey philox_key(std::uint64_t seed) {
  return {{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}};
}

/// Ten rounds. Two Weyl constants are added to the key after each round.
SIM_HD constexpr PhiloxWords philox4x32(PhiloxWords counter, PhiloxKey key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product0 = std::uint64_t{0xD2511F53u} * counter.w[0];
    const std::uint64_t product1 = std::uint64_t{0xCD9E8D57u} * counter.w[2];
    counter = {{static_cast<std::uint32_t>(product1 >> 32) ^ counter.w[1] ^ key.k[0],
                static_cast<std::uint32_t>(product1),
                static_cast<std::uint32_t>(product0 >> 32) ^ counter.w[3] ^ key.k[1],
                static_cast<std::uint32_t>(product0)}};
    key.k[0] += 0x9E3779B9u;
    key.k[1] += 0xBB67AE85u;
  }
  return counter;
}

/// Converts a random word to a uniform number in [0, 1). Uses the upper 24 bits, which a float represents
/// exactly.
SIM_HD constexpr float unit_float(std::uint32_t word) {
  return static_cast<float>(word >> 8) * (1.0f / 16777216.0f);
}

}  // namespace collidoscope
