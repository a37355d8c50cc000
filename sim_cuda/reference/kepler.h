#pragma once
// The two-body orbit: where a body is t seconds after it was at x0 with v0, pulled by mu / r^2 from the
// origin. Kepler's equation for the difference of eccentric anomalies, by Newton's method, then Lagrange's f
// and g (Battin 1999, 4.3). To a few units in the last place times the number of turns.

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

struct OrbitState {
  Vector3d position;  ///< m
  Vector3d velocity;  ///< m/s
};

/// mu in m^3/s^2, > 0; the orbit must be bound: |v|^2 < 2 mu / |x|.
OrbitState kepler_orbit(double mu, const OrbitState& start, double t);

/// s; of a bound orbit.
double kepler_period(double mu, const OrbitState& start);

}  // namespace collidoscope
