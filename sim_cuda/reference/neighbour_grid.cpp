#include "sim_cuda/reference/neighbour_grid.h"

#include <algorithm>

#include "sim_cuda/reference/contact_time.h"

namespace collidoscope {

NeighbourGrid::NeighbourGrid(const Vector3d& low, const Vector3d& high, double largest_diameter,
                             std::size_t count)
    : low_(low), width_(high - low), cells_{1, 1, 1} {
  int most = 1;
  while (static_cast<double>(most) * most * most < static_cast<double>(count)) ++most;
  for (int axis = 0; axis < 3; ++axis) {
    // The cell is 1 % wider than a diameter, to allow for rounding of edges and crossing times.
    const double fitting = width_[axis] / (1.01 * largest_diameter);
    cells_[axis] = fitting > 1 ? static_cast<int>(std::min<double>(fitting, most)) : 1;
    width_[axis] /= cells_[axis];
  }
  lists_.resize(static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2]);
  places_.reserve(count);
}

void NeighbourGrid::add(const Vector3d& x) {
  Place at{0, 0, 0};
  for (int axis = 0; axis < 3; ++axis)
    if (cells_[axis] > 1)
      at[axis] = static_cast<int>(std::clamp((x[axis] - low_[axis]) / width_[axis], 0.0, cells_[axis] - 1.0));
  list_at(at).push_back(static_cast<std::uint32_t>(places_.size()));
  places_.push_back(at);
}

NeighbourGrid::Crossing NeighbourGrid::next_crossing(std::uint32_t id, const Vector3d& x, const Vector3d& v,
                                                     const Vector3d& gravity) const {
  Crossing next{never, 0};
  for (int axis = 0; axis < 3; ++axis) {
    const int cell = places_[id][axis];
    const auto offer = [&](double after, int edge) {
      if (after < next.after) next = {after, edge};
    };
    if (cell > 0) {
      const double edge = low_[axis] + cell * width_[axis];
      offer(time_to_plane(x[axis] - edge, v[axis], gravity[axis], 0), 2 * axis);
    }
    if (cell + 1 < cells_[axis]) {
      const double edge = low_[axis] + (cell + 1) * width_[axis];
      offer(time_to_plane(edge - x[axis], -v[axis], -gravity[axis], 0), 2 * axis + 1);
    }
  }
  return next;
}

void NeighbourGrid::cross(std::uint32_t id, int edge) {
  Place& at = places_[id];
  std::vector<std::uint32_t>& list = list_at(at);
  *std::ranges::find(list, id) = list.back();
  list.pop_back();
  at[edge / 2] += edge % 2 ? 1 : -1;
  list_at(at).push_back(id);
}

NeighbourGrid::Range NeighbourGrid::around(const Place& at) const {
  Range cells;
  for (int axis = 0; axis < 3; ++axis) {
    cells.first[axis] = std::max(at[axis] - 1, 0);
    cells.last[axis] = std::min(at[axis] + 1, cells_[axis] - 1);
  }
  return cells;
}

}  // namespace collidoscope
