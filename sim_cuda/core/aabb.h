#pragma once
// Axis-aligned bounding boxes, in m. All broad phases test these float boxes, in single and double precision
// runs alike. A pair is two bodies whose boxes overlap.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

struct Aabb {
  Vector3f min, max;  ///< m; empty where min > max

  /// Overlaps no box, and is the neutral element of combine().
  SIM_HD static Aabb empty() {
    constexpr float inf = std::numeric_limits<float>::infinity();
    return {Vector3f(inf, inf, inf), Vector3f(-inf, -inf, -inf)};
  }
};
static_assert(sizeof(Aabb) == 24);

/// A box with a NaN coordinate is empty, too.
SIM_HD inline bool is_empty(const Aabb& box) {
  return !(box.min.x() <= box.max.x() && box.min.y() <= box.max.y() && box.min.z() <= box.max.z());
}

/// Closed intervals: boxes that share a face, an edge or a corner overlap. Branch-free: the branches are
/// unpredictable, and a misprediction costs more than all six comparisons.
SIM_HD inline bool overlap(const Aabb& a, const Aabb& b) {
  return (a.min.x() <= b.max.x()) & (b.min.x() <= a.max.x()) & (a.min.y() <= b.max.y()) &
         (b.min.y() <= a.max.y()) & (a.min.z() <= b.max.z()) & (b.min.z() <= a.max.z());
}

/// The smallest box that contains both.
SIM_HD inline Aabb combine(const Aabb& a, const Aabb& b) {
  Aabb box;
  for (int k = 0; k < 3; ++k) {
    box.min[k] = min_of(a.min[k], b.min[k]);
    box.max[k] = max_of(a.max[k], b.max[k]);
  }
  return box;
}

}  // namespace collidoscope
