#pragma once
// Angular velocities of freely rotating bodies, in double for every precision. A float is stored with the
// part that it lacks (double-float arithmetic, Dekker 1971).
//
// Reason: the rotation of a body with unequal moments of inertia changes its angular velocity in each
// substep. The rounding of these changes to float is a random walk of the energy: 2e-5 in 1,000 steps.

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Whether joined() ignores component k of `low`.
SIM_HD inline bool is_ignored(const Vector3<float>& high, const Vector3<float>& low, int k) {
  return !(static_cast<float>(static_cast<double>(high[k]) + static_cast<double>(low[k])) == high[k]);
}

/// The sum of `high` and `low`, per component. A component of `low` belongs to another `high`, and is
/// ignored, if the sum does not round to `high`.
SIM_HD inline Vector3d joined(const Vector3<float>& high, const Vector3<float>& low) {
  Vector3d sum;
  for (int k = 0; k < 3; ++k) {
    const double part = static_cast<double>(high[k]);
    sum[k] = is_ignored(high, low, k) ? part : part + static_cast<double>(low[k]);
  }
  return sum;
}

/// What `wide` lacks after rounding to float.
SIM_HD inline Vector3<float> low_part(const Vector3d& wide) {
  Vector3<float> low;
  for (int k = 0; k < 3; ++k)
    low[k] = static_cast<float>(wide[k] - static_cast<double>(static_cast<float>(wide[k])));
  return low;
}

}  // namespace collidoscope
