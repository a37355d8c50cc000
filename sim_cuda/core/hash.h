#pragma once
// 64-bit mixing functions, for state hashes and for order-independent priorities.

#include <bit>
#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014). A bijection; each input bit flips about half of the
/// output bits.
SIM_HD constexpr std::uint64_t mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Canonical bits of a number for hashing: -0 equals 0, and all NaN are equal.
SIM_HD constexpr std::uint64_t hash_bits(float x) {
  if (x != x) return 0x7fc00000u;
  return x == 0 ? 0 : std::bit_cast<std::uint32_t>(x);
}
SIM_HD constexpr std::uint64_t hash_bits(double x) {
  if (x != x) return 0x7ff8000000000000u;
  return x == 0 ? 0 : std::bit_cast<std::uint64_t>(x);
}

}  // namespace collidoscope
