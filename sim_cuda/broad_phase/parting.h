#pragma once
// Where two neighbouring leaves of a tree over sorted keys part: the higher the bit in which their keys
// differ, the nearer the root. Equal keys part by their places.
//
// At both ends of a subtree the heights differ: between two partings of one bit, where sorted numbers turn it
// on twice, stands one where they turned it off again, which takes a higher bit.

#include <bit>
#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Above all partings: either end of the list.
constexpr std::uint32_t highest_parting = 255;

SIM_HD inline std::uint32_t highest_bit(std::uint64_t x) {
#if defined(__CUDA_ARCH__)
  return 63 - static_cast<std::uint32_t>(__clzll(static_cast<long long>(x)));
#else
  return 63 - static_cast<std::uint32_t>(std::countl_zero(x));
#endif
}

/// Between leaves i and i + 1 of n; i may be n - 1 or -1. Less than highest_parting.
template <class Key>
SIM_HD std::uint32_t parting_height(const Key* keys, std::uint32_t n, std::uint32_t i) {
  if (i >= n - 1) return highest_parting;  // i = -1 too
  const Key differ = keys[i] ^ keys[i + 1];
  return differ != 0 ? 32 + highest_bit(differ) : highest_bit(i ^ (i + 1));
}

}  // namespace collidoscope
