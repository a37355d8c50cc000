#pragma once
// Every unordered pair of n things as one number: 0 .. n(n-1)/2 - 1, so that pairs are shared out like any
// other items. Pair (a, b), a < b, is number b(b-1)/2 + a: consecutive numbers have consecutive a, and the
// number does not depend on n.

#include <cmath>
#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"

namespace collidoscope {

/// Pairs of n <= 2^31 things.
SIM_HD constexpr std::uint64_t pair_count(std::uint64_t n) { return n < 2 ? 0 : n * (n - 1) / 2; }

/// The pair of that number, among at most 2^31 things. The square root of a float is only where the search
/// starts, a step or two from the answer while there are up to 2^24 things, and 2^7 at the most; integers
/// decide.
SIM_HD inline Pair decode_pair(std::uint64_t number) {
  using std::sqrt;
  auto b = static_cast<std::uint64_t>(sqrt(2 * static_cast<float>(number) + 0.25f) + 0.5f);
  while (pair_count(b) > number) --b;
  while (pair_count(b + 1) <= number) ++b;
  return {static_cast<std::uint32_t>(number - pair_count(b)), static_cast<std::uint32_t>(b)};
}

}  // namespace collidoscope
