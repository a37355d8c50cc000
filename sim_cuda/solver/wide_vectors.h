#pragma once
// Conversion of vectors between the precision of a run and double, for snapshots. Pure functions.

#include <array>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

template <class Real>
std::vector<std::array<double, 3>> widened_vectors(const std::vector<Vector3<Real>>& vectors,
                                                   std::size_t count) {
  std::vector<std::array<double, 3>> wide;
  wide.reserve(count);
  for (std::size_t k = 0; k < count; ++k)
    wide.push_back({static_cast<double>(vectors[k].x()), static_cast<double>(vectors[k].y()),
                    static_cast<double>(vectors[k].z())});
  return wide;
}
template <class Real>
Vector3<Real> narrowed_vector(const std::array<double, 3>& v) {
  return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}

}  // namespace collidoscope
