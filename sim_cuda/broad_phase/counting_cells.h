#pragma once
// Parameters of the counting sort of Morton keys (morton_order.h). Also used by the choice of the key length
// (key_bits.h).

#include <cstdint>

#include "sim_cuda/core/executor_options.h"

namespace collidoscope {

/// Cells with more bodies are sorted as a whole.
inline constexpr std::uint32_t large_cell_size = 128;

/// For keys of at most 32 bits. The counters of more than 2^21 cells exceed a GPU's cache.
inline bool sorts_by_counting(SortMethod sort, std::int64_t bodies) {
  return sort == SortMethod::automatic && bodies <= std::int64_t{1} << 21;
}

/// Number of leading key bits that select the cell. There are about as many cells as bodies.
inline int counting_cell_bits(std::int64_t bodies) {
  int bits = 6;
  while (std::int64_t{1} << bits < bodies) ++bits;
  return bits;
}

}  // namespace collidoscope
