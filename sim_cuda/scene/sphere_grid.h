#pragma once
// A uniform grid over spheres already placed: answers whether a new one would overlap any of them. Lives
// while `apart` places its bodies. (A broad phase that finds pairs is another matter: broad_phase/.)

#include <cstdint>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

class SphereGrid {
 public:
  /// A grid over the box low..high for queries with radii up to `largest_radius`; `expected` spheres in all.
  SphereGrid(const Vector3d& low, const Vector3d& high, double largest_radius, std::size_t expected);

  /// Spheres may have any radius and lie anywhere, outside the box too.
  void insert(const Vector3d& center, double radius);

  /// Whether the sphere (radius <= largest_radius) comes nearer to any other than a gap of 5e-7 of the sum
  /// of radii: a step that computes in float must not see a contact either.
  bool overlaps(const Vector3d& center, double radius) const;

 private:
  struct Sphere {
    Vector3d center;
    double radius;
    std::uint32_t next;  ///< in the same cell; `none` ends the list
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
  std::vector<Sphere> large_;  ///< larger than a cell is made for: compared with every query
};

}  // namespace collidoscope
