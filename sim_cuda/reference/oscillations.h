#pragma once
// What swings, in closed form: springs with damping, and the pendulum at any amplitude. SI units; t >= 0 from
// the start. Pure functions of libm, for errors to be measured against.

namespace collidoscope {

/// Where something is, and how fast: m and m/s, or rad and rad/s.
struct Oscillation {
  double at, rate;
};

/// x'' = -w^2 x - 2 z w x', let go at 1 with speed 0; w in rad/s > 0, z >= 0.
Oscillation damped_oscillation(double w, double z, double t);

/// theta'' = -w^2 sin theta, let go at `amplitude` (rad, |amplitude| < pi) with speed 0:
/// sin(theta/2) = k sn(w t + K, k^2), k = sin(amplitude/2).
Oscillation pendulum(double w, double amplitude, double t);

/// s, 4 K(k^2) / w.
double pendulum_period(double w, double amplitude);

}  // namespace collidoscope
