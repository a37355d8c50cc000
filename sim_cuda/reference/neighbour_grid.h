#pragma once
// Uniform grid that finds the spheres which may collide before either leaves its cell. Cells are at least as
// wide as the largest diameter, so the 27 cells around a body contain all candidates. The outermost cells
// extend to infinity.
// Owned by HardSpheres, which schedules the cell crossings. The grid does not change body states.
//
// The grid has one level. With radii uniform in (0, r], the 27 cells contain about 60 spheres at 30 % fill. A
// few much larger spheres make it slow, because the cost grows with the number of small spheres in 27 of
// their cells.

#include <array>
#include <cstdint>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

class NeighbourGrid {
 public:
  /// Covers low..high (m, low <= high) for spheres up to this diameter. Uses at most about one cell per body.
  NeighbourGrid(const Vector3d& low, const Vector3d& high, double largest_diameter, std::size_t count);

  /// Adds the next body, 0, 1, ..., to the cell of its position.
  void add(const Vector3d& x);

  /// Next cell edge that a centre crosses: 0 to 5, 2 axis + (1: upwards), and the time in s from now.
  struct Crossing {
    double after;
    int edge;
  };
  static constexpr int edges = 6;
  Crossing next_crossing(std::uint32_t id, const Vector3d& x, const Vector3d& v,
                         const Vector3d& gravity) const;
  void cross(std::uint32_t id, int edge);

  /// Calls visit(other) for every other body in the cells around a body.
  template <class Visit>
  void for_neighbours(std::uint32_t id, const Visit& visit) const {
    const Place& at = places_[id];
    visit_cells(around(at), [&](std::uint32_t other) {
      if (other != id) visit(other);
    });
  }
  /// Calls visit(other) for the bodies in the cells that became neighbours when this body last crossed
  /// `edge`.
  template <class Visit>
  void for_new_neighbours(std::uint32_t id, int edge, const Visit& visit) const {
    Range cells = around(places_[id]);
    const int axis = edge / 2;
    const int newest = places_[id][axis] + (edge % 2 ? 1 : -1);
    if (newest < 0 || newest >= cells_[axis]) return;
    cells.first[axis] = cells.last[axis] = newest;
    visit_cells(cells, visit);
  }

 private:
  using Place = std::array<int, 3>;
  struct Range {
    Place first, last;
  };
  Range around(const Place& at) const;
  std::vector<std::uint32_t>& list_at(const Place& at) { return lists_[index(at[0], at[1], at[2])]; }
  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * cells_[1] + y) * cells_[0] + x;
  }
  template <class Visit>
  void visit_cells(const Range& cells, const Visit& visit) const {
    for (int z = cells.first[2]; z <= cells.last[2]; ++z)
      for (int y = cells.first[1]; y <= cells.last[1]; ++y)
        for (int x = cells.first[0]; x <= cells.last[0]; ++x)
          for (const std::uint32_t other : lists_[index(x, y, z)]) visit(other);
  }

  Vector3d low_, width_;  // m, width of a cell
  std::array<int, 3> cells_;
  std::vector<std::vector<std::uint32_t>> lists_;  // bodies by cell, unordered
  std::vector<Place> places_;                      // cell by body
};

}  // namespace collidoscope
