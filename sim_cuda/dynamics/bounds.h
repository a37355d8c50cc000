#pragma once
// Bounding boxes of bodies: at their current position, or swept over a time interval.

#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/packed_vector.h"

namespace collidoscope {

/// The float box around [low, high]. Double values are rounded outward. If a bound is not finite, the box is
/// empty: it overlaps no box, and does not affect the boxes of a tree.
template <class Real>
SIM_HD Aabb box_around(const Vector3<Real>& low, const Vector3<Real>& high) {
  Aabb box;
  bool whole = true;
  for (int k = 0; k < 3; ++k) {
    box.min[k] = round_down(low[k]);
    box.max[k] = round_up(high[k]);
    whole = whole && finite(box.min[k]) && finite(box.max[k]);
  }
  return whole ? box : Aabb::empty();
}

template <class Real>
struct BodyBounds {
  const Vector3<Real>* position;
  const Real* radius;
  Aabb* boxes;

  SIM_HD void operator()(int body) const {
    const Vector3<Real> x = position[body], r = Vector3<Real>::Constant(radius[body]);
    boxes[body] = box_around<Real>(x - r, x + r);
  }
};

/// The motion of a body during `time` that its box covers: linear motion along its velocity, or a rebound at
/// `rebound` times the velocity, of the enlarged body, plus `acceleration_margin` in all directions. The
/// margin covers accelerations up to `acceleration_margin` / time^2. With `anywhere`, the box covers motion
/// in any direction at the current speed.
template <class Real>
struct Sweep {
  Real radius_factor;        ///< 1 or more
  Real time;                 ///< s
  Real acceleration_margin;  ///< m
  Real rebound;              ///< largest coefficient of restitution, 0 to 1
  bool anywhere = false;

  SIM_HD Aabb box(const Vector3<Real>& x, const Vector3<Real>& velocity, Real radius) const {
    const Vector3<Real> displacement = time * velocity;
    const Real r = radius_factor * radius + acceleration_margin;
    Vector3<Real> low, high;
    using std::sqrt;
    const Real reach = anywhere ? r + sqrt(displacement.dot(displacement)) : Real(0);
    for (int k = 0; k < 3; ++k) {
      const Real ahead = displacement[k], back = -rebound * ahead;
      low[k] = anywhere ? x[k] - reach : x[k] - r + min_of(ahead, back);
      high[k] = anywhere ? x[k] + reach : x[k] + r + max_of(ahead, back);
    }
    return box_around<Real>(low, high);
  }
};

template <class Real>
struct SweptBounds {
  const Vector3<Real>* position;
  const PackedVector3<Real>* velocity;
  const Real* radius;
  Aabb* boxes;
  Sweep<Real> sweep;

  SIM_HD void operator()(int body) const {
    boxes[body] = sweep.box(position[body], velocity[body].load(), radius[body]);
  }
};

struct LoadBox {
  const Aabb* boxes;
  SIM_HD Aabb operator()(std::int64_t body) const { return boxes[body]; }
};

}  // namespace collidoscope
