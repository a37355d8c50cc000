#pragma once
// The highest bit in which the keys of two neighbouring leaves differ (delta of Karras 2012): the higher it
// is, the nearer to the root the tree splits there. Equal keys differ by their places.
//
// At both ends of a subtree the split bits differ: between two splits at one bit, where sorted numbers turn
// it on twice, stands one where they turned it off again, which takes a higher bit.

#include <bit>
#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Above all split bits: either end of the list.
constexpr std::uint32_t max_split_bit = 255;

SIM_HD inline std::uint32_t highest_bit(std::uint64_t x) {
#if defined(__CUDA_ARCH__)
  return 63 - static_cast<std::uint32_t>(__clzll(static_cast<long long>(x)));
#else
  return 63 - static_cast<std::uint32_t>(std::countl_zero(x));
#endif
}

/// Between leaves i and i + 1 of n; i may be n - 1 or -1. Less than max_split_bit.
template <class Key>
SIM_HD std::uint32_t split_bit(const Key* keys, std::uint32_t n, std::uint32_t i) {
  if (i >= n - 1) return max_split_bit;  // i = -1 too
  const Key differ = keys[i] ^ keys[i + 1];
  return differ != 0 ? 32 + highest_bit(differ) : highest_bit(i ^ (i + 1));
}

}  // namespace collidoscope
