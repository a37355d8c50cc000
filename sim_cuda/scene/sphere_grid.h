#pragma once
// A uniform grid of placed spheres that tests new spheres for overlap. Used while `apart` places its bodies.
// It is not a broad phase (see broad_phase/).

#include <cstdint>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

class SphereGrid {
 public:
  /// Covers the box low..high, in metres. Queries have radii up to `largest_radius`. `expected` is the number
  /// of spheres that will be inserted.
  SphereGrid(const Vector3d& low, const Vector3d& high, double largest_radius, std::size_t expected);

  /// The sphere may have any radius and may lie outside the box.
  void insert(const Vector3d& center, double radius);

  /// True if the gap to another sphere is below 5e-7 of the sum of the radii. The margin prevents contacts in
  /// a float computation. Requires radius <= largest_radius.
  bool overlaps(const Vector3d& center, double radius) const;

 private:
  struct Sphere {
    Vector3d center;
    double radius;
    std::uint32_t next;  ///< next sphere in the same cell; `none` ends the list
  };
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  static bool touch(const Sphere& sphere, const Vector3d& center, double radius);
  int cell_along(int axis, double x) const;

  Vector3d low_;
  Vector3d cells_per_metre_;
  int cells_[3];
  double largest_radius_;
  std::vector<std::uint32_t> heads_;
  std::vector<Sphere> spheres_;
  std::vector<Sphere> large_;  ///< spheres larger than a cell allows; every query tests all of them
};

}  // namespace collidoscope
