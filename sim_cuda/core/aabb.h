#pragma once
// Axis-aligned boxes. All broad phases work on these float boxes, whatever the precision of the run: they
// define what a pair is.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

struct Aabb {
  Vector3f min, max;  ///< m; empty where min > max

  /// The box that nothing overlaps and that any merge leaves out.
  SIM_HD static Aabb empty() {
    constexpr float inf = std::numeric_limits<float>::infinity();
    return {Vector3f(inf, inf, inf), Vector3f(-inf, -inf, -inf)};
  }
};
static_assert(sizeof(Aabb) == 24);

/// Whether a box holds no point, NaN among its numbers included.
SIM_HD inline bool is_empty(const Aabb& box) {
  return !(box.min.x() <= box.max.x() && box.min.y() <= box.max.y() && box.min.z() <= box.max.z());
}

/// Closed: boxes that share a face, an edge or a corner overlap. Without a branch: which of the six decides
/// is anyone's guess, and a wrong guess costs more than all of them.
SIM_HD inline bool overlap(const Aabb& a, const Aabb& b) {
  return (a.min.x() <= b.max.x()) & (b.min.x() <= a.max.x()) & (a.min.y() <= b.max.y()) &
         (b.min.y() <= a.max.y()) & (a.min.z() <= b.max.z()) & (b.min.z() <= a.max.z());
}

/// The smallest box around both.
SIM_HD inline Aabb combine(const Aabb& a, const Aabb& b) {
  Aabb box;
  for (int k = 0; k < 3; ++k) {
    box.min[k] = min_of(a.min[k], b.min[k]);
    box.max[k] = max_of(a.max[k], b.max[k]);
  }
  return box;
}

}  // namespace collidoscope
