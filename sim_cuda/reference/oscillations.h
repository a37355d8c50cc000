#pragma once
// Oscillations in closed form: damped springs, and the pendulum at any amplitude. SI units; t >= 0 from the
// start. Pure functions for reference solutions; they use libm.

namespace collidoscope {

/// Position and rate: m and m/s, or rad and rad/s.
struct Oscillation {
  double at, rate;
};

/// Solution of x'' = -w^2 x - 2 z w x' with initial position 1 and speed 0. w in rad/s > 0, z >= 0.
Oscillation damped_oscillation(double w, double z, double t);

/// Solution of theta'' = -w^2 sin theta with initial angle `amplitude` (rad, |amplitude| < pi) and speed 0.
/// sin(theta/2) = k sn(w t + K, k^2), k = sin(amplitude/2).
Oscillation pendulum(double w, double amplitude, double t);

/// Period in s, 4 K(k^2) / w.
double pendulum_period(double w, double amplitude);

}  // namespace collidoscope
