#pragma once
// Symmetric 3 x 3 linear systems with a fixed order of operations. Pure functions.

#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

template <class Real>
struct Symmetric3 {
  Real xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  /// Solves A x = b for a positive semidefinite A (LDL^T). Components with a zero pivot are 0.
  SIM_HD Vector3<Real> solve(const Vector3<Real>& b) const {
    const Real d0 = inverse(xx), l1 = xy * d0, l2 = xz * d0;
    const Real d1 = inverse(yy - l1 * xy), c = yz - l2 * xy, l3 = c * d1;
    const Real d2 = inverse(zz - l2 * xz - l3 * c);
    const Real u = b.x(), v = b.y() - l1 * u, w = b.z() - l2 * u - l3 * v;
    const Real z = w * d2, y = v * d1 - l3 * z;
    return {u * d0 - l1 * y - l2 * z, y, z};
  }

 private:
  SIM_HD static Real inverse(Real pivot) { return pivot > 0 ? 1 / pivot : Real(0); }
};

}  // namespace collidoscope
