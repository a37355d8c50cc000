#pragma once
// When Morton keys are sorted by counting, and in how many cells (morton_order.h). Shared with the choice of
// the key length (key_bits.h).

#include <cstdint>

#include "sim_cuda/core/executor_options.h"

namespace collidoscope {

/// Bodies in a cell of a counting sort, beyond which they are sorted together.
inline constexpr std::uint32_t large_cell_size = 128;

/// For keys of at most 32 bits. Beyond 2^21 cells their counters leave a GPU's cache.
inline bool sorts_by_counting(SortMethod sort, std::int64_t bodies) {
  return sort == SortMethod::automatic && bodies <= std::int64_t{1} << 21;
}

/// Leading bits of a key that number its cell: as many cells as bodies.
inline int counting_cell_bits(std::int64_t bodies) {
  int bits = 6;
  while (std::int64_t{1} << bits < bodies) ++bits;
  return bits;
}

}  // namespace collidoscope
