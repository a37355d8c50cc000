#pragma once
// The two-body orbit: state at time t for the initial state (x0, v0) and the acceleration mu / r^2 towards
// the origin.
// Solves Kepler's equation for the difference of eccentric anomalies by Newton's method, then uses Lagrange's
// f and g (Battin 1999, 4.3). The error is a few units in the last place times the number of orbits.

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

struct OrbitState {
  Vector3d position;  ///< m
  Vector3d velocity;  ///< m/s
};

/// State after t s. mu in m^3/s^2, > 0. The orbit must be bound: |v|^2 < 2 mu / |x|.
OrbitState kepler_orbit(double mu, const OrbitState& start, double t);

/// Period of a bound orbit in s.
double kepler_period(double mu, const OrbitState& start);

}  // namespace collidoscope
