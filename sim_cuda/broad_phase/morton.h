#pragma once
// Morton keys: positions along a z-order curve, as in the paper's Figure 6. Bodies that are close in space
// are likely to be close in this order. 30-bit keys have 10 bits per axis, 63-bit keys have 21. Keys affect
// the quality of a tree, not the pairs found.

#include <cstdint>

#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/arithmetic.h"

namespace collidoscope {

/// Spreads the lowest 21 bits of x, with two zero bits between consecutive bits.
SIM_HD constexpr std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x001f00000000ffffu;
  x = (x | x << 16) & 0x001f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  x = (x | x << 2) & 0x1249249249249249u;
  return x;
}

/// Interleaves three cell indices; x is the highest bit of each triple.
SIM_HD constexpr std::uint64_t morton(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread_bits(x) << 2 | spread_bits(y) << 1 | spread_bits(z);
}

/// Key of a box's centre within `extent`. Centres outside are clamped to the border cells. Empty boxes are in
/// the first cell along each axis.
template <class Key>
SIM_HD Key morton_key(const Aabb& box, const Aabb& extent) {
  constexpr std::uint32_t cells = sizeof(Key) == 4 ? 1u << 10 : 1u << 21;
  std::uint32_t cell[3];
  for (int k = 0; k < 3; ++k) {
    const float side = extent.max[k] - extent.min[k];
    const float center = 0.5f * box.min[k] + 0.5f * box.max[k];
    cell[k] = side > 0 ? to_cell((center - extent.min[k]) / side * static_cast<float>(cells), cells) : 0;
  }
  return static_cast<Key>(morton(cell[0], cell[1], cell[2]));
}

}  // namespace collidoscope
