#pragma once
// Union-find over body ids, for concurrent use within one stage. `parent[i]` = i at the start. After the
// stage, the root of a set is its lowest id, so the result does not depend on the order of the unions.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/atomics.h"

namespace collidoscope {

/// Current root of the set of `id`. Other threads may join sets concurrently.
SIM_HD inline std::uint32_t root_of(std::uint32_t* parent, std::uint32_t id) {
  std::uint32_t at = atomic_load(&parent[id]);
  for (std::uint32_t before = id; at != before;) {
    const std::uint32_t above = atomic_load(&parent[at]);
    if (above == at) break;
    atomic_store(&parent[before], above);  // benign race: every thread stores an ancestor
    before = at;
    at = above;
  }
  return at;
}

SIM_HD inline void join_sets(std::uint32_t* parent, std::uint32_t a, std::uint32_t b) {
  a = root_of(parent, a);
  b = root_of(parent, b);
  while (a != b) {
    const std::uint32_t low = min_of(a, b), high = max_of(a, b);
    a = low;
    b = atomic_compare_exchange(&parent[high], high, low);
    if (b == high) return;  // `high` was a root and is linked now
  }
}

}  // namespace collidoscope
