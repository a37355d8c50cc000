#pragma once
// The split bit: the highest bit in which the keys of two adjacent leaves differ (delta of Karras 2012). A
// higher split bit means a split nearer to the root. Equal keys are distinguished by their places.
//
// The split bits at both ends of a subtree differ. Reason: two splits at the same bit both set it in
// ascending order. A split between them must clear it, and so has a higher split bit.

#include <bit>
#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Larger than all split bits; used at both ends of the list.
constexpr std::uint32_t max_split_bit = 255;

SIM_HD inline std::uint32_t highest_bit(std::uint64_t x) {
#if defined(__CUDA_ARCH__)
  return 63 - static_cast<std::uint32_t>(__clzll(static_cast<long long>(x)));
#else
  return 63 - static_cast<std::uint32_t>(std::countl_zero(x));
#endif
}

/// Split bit between leaves i and i + 1 of n. For i = n - 1 and i = -1 it is max_split_bit; otherwise it is
/// less.
template <class Key>
SIM_HD std::uint32_t split_bit(const Key* keys, std::uint32_t n, std::uint32_t i) {
  if (i >= n - 1) return max_split_bit;  // i = -1 too
  const Key differ = keys[i] ^ keys[i + 1];
  return differ != 0 ? 32 + highest_bit(differ) : highest_bit(i ^ (i + 1));
}

}  // namespace collidoscope
