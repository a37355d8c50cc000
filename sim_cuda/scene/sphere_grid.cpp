#include "sim_cuda/scene/sphere_grid.h"

#include <algorithm>

namespace collidoscope {

SphereGrid::SphereGrid(const Vector3d& low, const Vector3d& high, double largest_radius, std::size_t expected)
    : low_(low), cells_per_metre_(0, 0, 0), cells_{1, 1, 1}, largest_radius_(largest_radius) {
  // A cell is at least as wide as the largest diameter, so overlaps lie within 27 cells. The number of cells
  // is at most 32 times that of spheres.
  int most = 1;
  while (most < 512 && static_cast<double>(most) * most * most < 4.0 * static_cast<double>(expected))
    most *= 2;
  for (int axis = 0; axis < 3; ++axis) {
    const double side = high[axis] - low[axis];
    // The cell is 1 % wider than the diameter. This covers the rounding of cell indices and the gap.
    const double fitting = side / (2.02 * largest_radius);
    cells_[axis] = static_cast<int>(std::clamp(fitting, 1.0, static_cast<double>(most)));
    cells_per_metre_[axis] = cells_[axis] / side;
  }
  heads_.assign(static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2], none);
  spheres_.reserve(expected);
}

int SphereGrid::cell_along(int axis, double x) const {
  const double cell = (x - low_[axis]) * cells_per_metre_[axis];
  return static_cast<int>(std::clamp(cell, 0.0, cells_[axis] - 1.0));
}

void SphereGrid::insert(const Vector3d& center, double radius) {
  if (radius > largest_radius_) {
    large_.push_back({center, radius, none});
    return;
  }
  const std::size_t cell =
      (static_cast<std::size_t>(cell_along(2, center[2])) * cells_[1] + cell_along(1, center[1])) *
          cells_[0] +
      cell_along(0, center[0]);
  spheres_.push_back({center, radius, heads_[cell]});
  heads_[cell] = static_cast<std::uint32_t>(spheres_.size() - 1);
}

bool SphereGrid::touch(const Sphere& sphere, const Vector3d& center, double radius) {
  const Vector3d d = sphere.center - center;
  const double reach = sphere.radius + radius;
  return d.dot(d) <= reach * reach * (1 + 1e-6);
}

bool SphereGrid::overlaps(const Vector3d& center, double radius) const {
  for (const Sphere& sphere : large_) {
    if (touch(sphere, center, radius)) return true;
  }
  int first[3], last[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int cell = cell_along(axis, center[axis]);
    first[axis] = std::max(cell - 1, 0);
    last[axis] = std::min(cell + 1, cells_[axis] - 1);
  }
  for (int z = first[2]; z <= last[2]; ++z) {
    for (int y = first[1]; y <= last[1]; ++y) {
      for (int x = first[0]; x <= last[0]; ++x) {
        const std::size_t cell = (static_cast<std::size_t>(z) * cells_[1] + y) * cells_[0] + x;
        for (std::uint32_t i = heads_[cell]; i != none; i = spheres_[i].next) {
          if (touch(spheres_[i], center, radius)) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace collidoscope
