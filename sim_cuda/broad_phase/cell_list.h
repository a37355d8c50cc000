#pragma once
// Cell lists: what the uniform and the hierarchical grid share. Bodies are sorted (by counting) into the
// cells of one or several grids, called levels; a body then looks through the cells, in its own level and in
// all coarser ones, that can hold a body which its box overlaps. The two methods differ in how they lay out
// the levels, which happens on the device, from this step's boxes.
//
// Why rounding cannot lose a pair. A body stands in the cell of its box's low corner. Let j be a body whose
// box overlaps that of i, in a level of reach R, which is no less than any side of any box there. Then on
// each axis min_j <= max_i, since they overlap, and min_j >= max_j - R >= min_i - R >= down(min_i - R), where
// down is the next float below the rounded difference. So the cells from index(down(min_i - R)) to
// index(max_i) hold the low corner of j, because index() never falls where its argument grows: a subtraction,
// a product with a positive number, a clamp and a truncation each keep the order, rounded or not. The origin,
// the size of cells and whether the extent is true decide about speed alone.

#include <cstdint>

#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/buffer.h"

namespace collidoscope {

/// No less than any side of a box; 0 where it is empty.
SIM_HD inline float longest_side(const Aabb& box) {
  if (is_empty(box)) return 0;
  const Vector3f d = box.max - box.min;
  return next_up(max_of(max_of(d.x(), d.y()), d.z()));
}

/// One grid. The extent takes `cells` along each axis; what lies outside counts as on its border. Memory for
/// all of these would have no bound (an outlier 10^6 m away, dust in a hall), so cell numbers repeat with the
/// period `period` <= `cells`: cells that share a number share a list, which costs tests, never pairs.
struct GridLevel {
  static constexpr std::uint32_t max_cells = 1u << 21;  ///< along an axis: neighbours differ as floats

  Vector3f origin;               ///< m, low corner of the first cell
  float cells_per_metre;         ///< 0: one cell is all
  float reach;                   ///< m; the longest side of a box that stands here
  std::uint32_t cells[3];        ///< 1 to max_cells
  std::uint32_t period[3];       ///< 1 to cells
  std::uint32_t first_list = 0;  ///< of the period[0] * period[1] * period[2] lists of this level

  SIM_HD std::uint32_t index(int axis, float x) const {
    return to_cell((x - origin[axis]) * cells_per_metre, cells[axis]);
  }
  SIM_HD std::uint32_t list(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {  // each < period
    return first_list + (z * period[1] + y) * period[0] + x;
  }
  SIM_HD std::uint32_t wrap(int axis, std::uint32_t index) const {
    return index < period[axis] ? index : index % period[axis];
  }
  SIM_HD std::uint32_t list_of(const float* low) const {
    return list(wrap(0, index(0, low[0])), wrap(1, index(1, low[1])), wrap(2, index(2, low[2])));
  }
};

/// A level over the extent for boxes of at most `reach` on a side, in at most `room` (>= 1) lists. Cells are
/// a quarter of the reach to twice it: the finest for which every cell has a list of its own, else the
/// largest.
SIM_HD inline GridLevel make_level(const Aabb& extent, float reach, std::uint64_t room) {
  const float finest = max_of(longest_side(extent) * 0x1p-20f, 0x1p-100f);  // its cells can be numbered
  GridLevel level{extent.min, 0, reach, {}, {}};
  std::uint32_t* const period = level.period;
  const auto fits = [&] { return std::uint64_t{period[0]} * period[1] * period[2] <= room; };
  for (float size = 0.25f; size <= 2; size *= 1.25f) {
    level.cells_per_metre = 1 / max_of(size * reach, finest);
    for (int k = 0; k < 3; ++k)
      level.cells[k] = period[k] =
          to_cell((extent.max[k] - extent.min[k]) * level.cells_per_metre, GridLevel::max_cells) + 1;
    if (fits()) return level;
  }
  while (!fits()) {
    const int longest = period[0] >= period[1] && period[0] >= period[2] ? 0 : period[1] >= period[2] ? 1 : 2;
    period[longest] = (period[longest] + 1) / 2;
  }
  return level;
}

/// All levels, finest first, in the executor's memory. Bodies are told apart by the class of their longest
/// side: the classes are powers of two, and a level may hold several.
struct CellGrid {
  static constexpr std::int32_t classes = 23;
  std::int32_t first_power;  ///< power_of() of class 0, which holds smaller ones too; the last, the rest
  std::int32_t level_of[classes];  ///< where the bodies of a class stand
  std::uint32_t occupied;          ///< bit k: level k is laid out. The others hold nobody
  GridLevel levels[classes];

  /// The power of two that is next above a side >= 0 (m), as the exponents of floats count; 0 to max_power.
  SIM_HD static constexpr std::int32_t power_of(float side) {
    const auto bits = std::bit_cast<std::uint32_t>(side);
    return static_cast<std::int32_t>((bits >> 23) + ((bits & 0x7fffff) != 0));
  }
  static constexpr std::int32_t max_power = 255;
  SIM_HD static constexpr std::int32_t class_of(float side, std::int32_t first_power) {
    return clamp_to(power_of(side) - first_power, 0, classes - 1);
  }
};

/// Threads that share one look at all boxes, each of which then bids once for the longest side.
inline constexpr std::int64_t histogram_lanes = 1 << 17;

class CellList {
 public:
  explicit CellList(Executor& executor);
  /// `lists`: as many as the levels will ever take together.
  void reserve(std::int64_t bodies, std::int64_t lists);
  /// Where the levels are to be laid out before sort().
  CellGrid* grid() const { return grid_.data(); }
  void sort(const Aabb* boxes);
  void find_pairs(const PairSink& sink);

  /// A body in the order of lists. 32 bytes: a GPU reads it in two loads from one sector.
  struct alignas(16) Entry {
    float min[3];
    std::uint32_t body;
    float max[3];
    std::int32_t level;  ///< -1: the box is empty
  };
  static_assert(sizeof(Entry) == 32);

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0, lists_ = 0;
  Buffer<CellGrid> grid_;
  Buffer<std::uint32_t> count_;  ///< bodies in each list; zero between updates
  Buffer<std::uint32_t> start_;  ///< the first entry of each list
  Buffer<Entry> entries_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope
