#pragma once
// Pairs of body ids, and lookup in ordered lists of pairs. Plain data.

#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Two ids a < b. In pair lists, their boxes overlap.
struct Pair {
  std::uint32_t a, b;

  SIM_HD bool precedes(std::uint32_t other_a, std::uint32_t other_b) const {
    return a < other_a || (a == other_a && b < other_b);
  }
};

inline constexpr std::uint32_t no_pair = 0xffffffffu;

/// Index of (a, b) in pairs[low] .. pairs[high - 1]; `no_pair` if absent. Precondition: the list is ordered
/// by a, then b.
SIM_HD inline std::uint32_t find_pair(const Pair* pairs, std::uint32_t low, std::uint32_t high,
                                      std::uint32_t a, std::uint32_t b) {
  const std::uint32_t end = high;
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (pairs[middle].precedes(a, b))
      low = middle + 1;
    else
      high = middle;
  }
  return low < end && pairs[low].a == a && pairs[low].b == b ? low : no_pair;
}

}  // namespace collidoscope
