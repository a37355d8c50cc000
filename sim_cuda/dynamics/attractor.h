#pragma once
// Attractors: fixed points that attract every body with Newtonian gravity, with Plummer softening (1911),
// which keeps the acceleration finite:
//
//   a = -mu d / (|d|^2 + eps^2)^(3/2),  potential -mu / sqrt(|d|^2 + eps^2) J/kg, 0 far away
//
// d is the vector from the point to the body; mu in m^3/s^2; eps > 0 in m; ranges in scene/limits.h. The
// effect is required if the scene has attractors.
//
// The speculative margin of a step uses the largest acceleration, 2 mu / (3 sqrt(3) eps^2), at |d| = eps /
// sqrt(2). An eps far below all relevant distances therefore creates many speculative contacts that never
// touch.

#include <cmath>
#include <vector>

#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

template <class Real>
struct PointAttractor {
  Vector3<Real> position;  ///< m
  Real strength;           ///< m^3/s^2
  Real softening;          ///< m, > 0

  static PointAttractor of(const Attractor& attractor) {
    return {attractor.position.cast<Real>(), static_cast<Real>(attractor.strength),
            static_cast<Real>(attractor.softening)};
  }
  /// m/s^2.
  SIM_HD Vector3<Real> acceleration(const Vector3<Real>& x) const {
    const Vector3<Real> d = position - x;
    const Real squared = d.dot(d) + softening * softening;
    using std::sqrt;
    return strength / squared / sqrt(squared) * d;
  }
  /// J/kg.
  SIM_HD double potential(const Vector3d& x) const {
    const Vector3d d = x - position.template cast<double>();
    const double eps = static_cast<double>(softening);
    using std::sqrt;
    return -static_cast<double>(strength) / sqrt(d.dot(d) + eps * eps);
  }
};

/// All attractors of the scene, in the executor's memory.
template <class Real>
struct AttractorView {
  const PointAttractor<Real>* points = nullptr;
  int count = 0;
};

/// Writes the total acceleration by attractors, m/s^2, at the position of each body.
template <class Real>
struct EvaluateField {
  AttractorView<Real> attractors;
  const Vector3<Real>* position;
  Vector3<Real>* field;

  SIM_HD void operator()(int body) const {
    const Vector3<Real> x = position[body];
    Vector3<Real> sum = Vector3<Real>::Zero();
    for (int k = 0; k < attractors.count; ++k) sum += attractors.points[k].acceleration(x);
    field[body] = sum;
  }
};

}  // namespace collidoscope
