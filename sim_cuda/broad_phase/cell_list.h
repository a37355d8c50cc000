#pragma once
// Cell lists, shared by the uniform and the hierarchical grid. Bodies are sorted (by counting) into the cells
// of one or several grids, called levels. A query searches the body's own level and all coarser ones, in the
// cells that can contain overlapping bodies. The two methods differ in the layout of the levels, which is
// computed on the device from this step's boxes.
//
// Rounding cannot lose a pair. A body is stored in the cell of its box's low corner. Let j be a body in a
// level of reach R, whose box overlaps that of i. R is an upper bound of the side lengths of all boxes in the
// level. On each axis min_j <= max_i, because the boxes overlap. Also min_j >= max_j - R >= min_i - R >=
// down(min_i - R), where down is the next float below the rounded difference.
//
// index() is monotone, because subtraction, multiplication by a positive number, clamping and truncation are
// monotone, with or without rounding. So the cells index(down(min_i - R)) to index(max_i) contain the low
// corner of j. Origin, cell size and extent affect the speed only.

#include <cstdint>

#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/buffer.h"

namespace collidoscope {

/// Upper bound of the side lengths of a box; 0 if it is empty.
SIM_HD inline float longest_side(const Aabb& box) {
  if (is_empty(box)) return 0;
  const Vector3f d = box.max - box.min;
  return next_up(max_of(max_of(d.x(), d.y()), d.z()));
}

/// One grid. Its `cells` cover the extent along each axis; positions outside are clamped to the border cells.
/// Memory for all cells would be unbounded (an outlier 10^6 m away, dust in a hall). Cell numbers therefore
/// repeat with the period `period` <= `cells`. Cells with equal numbers share a list, which costs tests but
/// loses no pairs.
struct GridLevel {
  static constexpr std::uint32_t max_cells = 1u << 21;  ///< per axis; distinct as floats

  Vector3f origin;               ///< m, low corner of the grid
  float cells_per_metre;         ///< 0: there is a single cell
  float reach;                   ///< m; upper bound of the sides of boxes in this level
  std::uint32_t cells[3];        ///< 1 to max_cells
  std::uint32_t period[3];       ///< 1 to cells
  std::uint32_t first_list = 0;  ///< first of the period[0] * period[1] * period[2] lists of this level

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

/// Lays out a level over the extent for boxes with sides of at most `reach`, in at most `room` (>= 1) lists.
/// Cell sizes range from a quarter of the reach to twice the reach. Chooses the smallest size for which every
/// cell has its own list, otherwise the largest.
SIM_HD inline GridLevel make_level(const Aabb& extent, float reach, std::uint64_t room) {
  const float finest = max_of(longest_side(extent) * 0x1p-20f, 0x1p-100f);  // m; limits cell numbers
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

/// All levels, finest first, in the executor's memory. Bodies are classified by their longest side, in powers
/// of two. A level may contain several classes.
struct CellGrid {
  static constexpr std::int32_t classes = 23;
  std::int32_t first_power;        ///< power_of() of class 0. Outliers are in the first or last class
  std::int32_t level_of[classes];  ///< level of each class
  std::uint32_t occupied;          ///< bit k: level k is in use; the others contain no bodies
  GridLevel levels[classes];

  /// The smallest power of two >= `side` (m), side >= 0, as a biased float exponent: 0 to max_power.
  SIM_HD static constexpr std::int32_t power_of(float side) {
    const auto bits = std::bit_cast<std::uint32_t>(side);
    return static_cast<std::int32_t>((bits >> 23) + ((bits & 0x7fffff) != 0));
  }
  static constexpr std::int32_t max_power = 255;
  SIM_HD static constexpr std::int32_t class_of(float side, std::int32_t first_power) {
    return clamp_to(power_of(side) - first_power, 0, classes - 1);
  }
};

/// Number of threads that compute the maximum side of all boxes. Each thread updates the result once.
inline constexpr std::int64_t histogram_lanes = 1 << 17;

class CellList {
 public:
  explicit CellList(Executor& executor);
  /// `lists`: maximum total number of lists of all levels.
  void reserve(std::int64_t bodies, std::int64_t lists);
  /// The levels; must be laid out before sort().
  CellGrid* grid() const { return grid_.data(); }
  void sort(const Aabb* boxes);
  void find_pairs(const PairSink& sink);

  /// A body, in list order. 32 bytes: two loads from one sector on a GPU.
  struct alignas(16) Entry {
    float min[3];
    std::uint32_t body;
    float max[3];
    std::int32_t level;  ///< -1 if the box is empty
  };
  static_assert(sizeof(Entry) == 32);

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0, lists_ = 0;
  Buffer<CellGrid> grid_;
  Buffer<std::uint32_t> count_;  ///< bodies per list; zero between updates
  Buffer<std::uint32_t> start_;  ///< first entry of each list
  Buffer<Entry> entries_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope
