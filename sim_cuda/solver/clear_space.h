#pragma once
// The space in which a body is clear of all planes of the scene. Its test is faster than that of the six
// faces of the box, and most bodies pass it.

#include <cmath>
#include <optional>

#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

template <class Real>
struct ClearSpace {
  Vector3<Real> centre, half;  ///< m; a box. half < 0: no body is known to be clear
  Real time;                   ///< s; more than a substep, for rounding

  /// `h`: substep, s. Empty if there are other planes than the faces of the box.
  static ClearSpace of(const std::optional<Box>& box, int plane_count, Real h) {
    constexpr int faces = 6;
    constexpr double margin = 1e-5;  // share of the coordinates; more than their rounding
    ClearSpace space{Vector3<Real>::Zero(), Vector3<Real>::Constant(-1), Real(1.0001) * h};
    if (!box || plane_count != faces) return space;
    const Vector3d middle = (box->min + box->max) / 2, size = (box->max - box->min) / 2;
    space.centre = middle.cast<Real>();
    space.half = (size - margin * (middle.cwiseAbs() + size)).cast<Real>();
    return space;
  }
  /// True if a body at x does not touch a face if it moves by `way` in any direction along each axis, m. May
  /// be false for a body that is clear. False for numbers that are not finite.
  SIM_HD bool contains(const Vector3<Real>& x, Real radius, const Vector3<Real>& way) const {
    bool inside = true;  // without branches: their outcome cannot be predicted
    for (int k = 0; k < 3; ++k) {
      using std::abs;
      inside &= abs(x[k] - centre[k]) + abs(way[k]) + radius < half[k];
    }
    return inside;
  }
};

}  // namespace collidoscope
