#pragma once
// Numbering of the unordered pairs of n elements: 0 .. n(n-1)/2 - 1, so that pairs can be distributed like
// any items. Pair (a, b), a < b, has the number b(b-1)/2 + a. Consecutive numbers have consecutive a. The
// number does not depend on n.

#include <cmath>
#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"

namespace collidoscope {

/// Number of pairs of n <= 2^31 elements.
SIM_HD constexpr std::uint64_t pair_count(std::uint64_t n) { return n < 2 ? 0 : n * (n - 1) / 2; }

/// The pair with the given number, of at most 2^31 elements. A float square root gives the start of the
/// search; its error is one or two steps up to 2^24 elements, and at most 2^7. The search is exact, in
/// integers.
SIM_HD inline Pair decode_pair(std::uint64_t number) {
  using std::sqrt;
  auto b = static_cast<std::uint64_t>(sqrt(2 * static_cast<float>(number) + 0.25f) + 0.5f);
  while (pair_count(b) > number) --b;
  while (pair_count(b + 1) <= number) ++b;
  return {static_cast<std::uint32_t>(number - pair_count(b)), static_cast<std::uint32_t>(b)};
}

}  // namespace collidoscope
