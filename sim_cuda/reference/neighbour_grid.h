#pragma once
// Which spheres may touch before either leaves its cell: a uniform grid of cells at least a largest diameter
// wide, so that those of the 27 cells around are all. Bodies are told when they cross an edge; the outermost
// cells reach to infinity. Owned by HardSpheres, which schedules the crossings; the grid changes no state of
// a body.
//
// One level of cells: with radii uniform in (0, r] about 60 spheres lie in 27 cells at 30 % full. A few
// spheres much larger than the rest make it as slow as the number of small ones in 27 of their diameters
// cubed.

#include <array>
#include <cstdint>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

class NeighbourGrid {
 public:
  /// Over low..high (m, low <= high), for spheres up to this diameter; about a cell for each of `count` at
  /// most.
  NeighbourGrid(const Vector3d& low, const Vector3d& high, double largest_diameter, std::size_t count);

  /// Puts the bodies 0, 1, ... into the cells of their positions, in this order.
  void add(const Vector3d& x);

  /// The edge that a centre crosses next: 0 to 5, 2 axis + (1: upwards), and s from now.
  struct Crossing {
    double after;
    int edge;
  };
  static constexpr int edges = 6;
  Crossing next_crossing(std::uint32_t id, const Vector3d& x, const Vector3d& v,
                         const Vector3d& gravity) const;
  void cross(std::uint32_t id, int edge);

  /// visit(other) for all in the cells around a body but itself.
  template <class Visit>
  void for_neighbours(std::uint32_t id, const Visit& visit) const {
    const Place& at = places_[id];
    visit_cells(around(at), [&](std::uint32_t other) {
      if (other != id) visit(other);
    });
  }
  /// The same of the cells that came into its reach when it crossed this edge last.
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

  Vector3d low_, width_;  // m, of a cell
  std::array<int, 3> cells_;
  std::vector<std::vector<std::uint32_t>> lists_;  // who is in a cell, in no order
  std::vector<Place> places_;                      // by body
};

}  // namespace collidoscope
