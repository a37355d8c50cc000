#pragma once
// Bounds: the box of each body, where it is or for a while to come.

#include "sim_cuda/broad_phase/aabb.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Double runs round outward, so that the float box holds the sphere. A body whose position is not finite
/// gets an empty box: it meets nobody, and the tree around it stays whole.
template <class Real>
struct Bounds {
  const Vector3<Real>* position;
  const Real* radius;
  Aabb* boxes;

  SIM_HD void operator()(int body) const {
    const Vector3<Real> x = position[body];
    const Real r = radius[body];
    Aabb box;
    bool whole = true;
    for (int k = 0; k < 3; ++k) {
      box.min[k] = round_down(x[k] - r);
      box.max[k] = round_up(x[k] + r);
      whole = whole && finite(box.min[k]) && finite(box.max[k]);
    }
    boxes[body] = whole ? box : Aabb::empty();
  }
};

/// The box of all that the body will pass through in `time` while it moves smoothly: along its velocity, and
/// aside by what an acceleration of at most `slack` / time^2 makes of it.
template <class Real>
struct SweptBounds {
  const Vector3<Real>*position, *velocity;
  const Real* radius;
  Real time;   ///< s
  Real slack;  ///< m
  Aabb* boxes;

  SIM_HD void operator()(int body) const {
    const Vector3<Real> x = position[body], way = time * velocity[body];
    const Real r = radius[body] + slack;
    Aabb box;
    bool whole = true;
    for (int k = 0; k < 3; ++k) {
      box.min[k] = round_down(x[k] - r + min_of(way[k], Real(0)));
      box.max[k] = round_up(x[k] + r + max_of(way[k], Real(0)));
      whole = whole && finite(box.min[k]) && finite(box.max[k]);
    }
    boxes[body] = whole ? box : Aabb::empty();
  }
};

struct LoadBox {
  const Aabb* boxes;
  SIM_HD Aabb operator()(std::int64_t body) const { return boxes[body]; }
};

}  // namespace collidoscope
