#pragma once
// Impact, rebound, sliding and rolling of spheres in closed form (laws of Newton and Coulomb). SI units.
// Stateless functions.

#include <algorithm>
#include <cmath>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

struct TwoVelocities {
  Vector3d a, b;  ///< m/s
};

/// Velocities after a frictionless impact along `normal` (unit, from a to b) with restitution e. Momentum is
/// conserved. The normal separation speed is e times the approach speed.
inline TwoVelocities after_impact(double mass_a, double mass_b, const TwoVelocities& before,
                                  const Vector3d& normal, double e) {
  const double approach = (before.a - before.b).dot(normal);
  const double impulse = (1 + e) * approach * mass_a * mass_b / (mass_a + mass_b);
  return {before.a - impulse / mass_a * normal, before.b + impulse / mass_b * normal};
}

struct Motion3 {
  Vector3d velocity;  ///< m/s
  Vector3d spin;      ///< rad/s
};

/// State of a solid sphere after an impact on a plane (unit normal). If Coulomb's cone allows, the contact
/// point stops slipping, which changes the centre's velocity by 2/7 of the slip. Otherwise the change is the
/// maximum, mu (1 + e) times the approach speed.
inline Motion3 after_bounce(const Motion3& before, double radius, const Vector3d& normal, double e,
                            double mu) {
  const double approach = -before.velocity.dot(normal);
  const Vector3d at_contact = before.velocity - radius * before.spin.cross(normal);
  const Vector3d slip = at_contact - at_contact.dot(normal) * normal;
  const double most = slip.norm() > 0 ? mu * (1 + e) * approach / slip.norm() : 0;
  const Vector3d change = -std::min(2.0 / 7, most) * slip;  // of the centre's velocity
  return {before.velocity + (1 + e) * approach * normal + change,
          before.spin - 5 / (2 * radius) * normal.cross(change)};
}

/// A ball dropped through `fall` m onto a plane, bouncing with restitution e.
struct Rebounds {
  double gravity, fall, e;  ///< m/s^2, m, 0 to 1

  double first_speed() const { return std::sqrt(2 * gravity * fall); }  ///< m/s, at the first impact
  double first_time() const { return std::sqrt(2 * fall / gravity); }   ///< s, of the first impact
  /// Speeds in m/s before and after the n-th impact, n >= 1.
  double impact_speed(int n) const { return std::pow(e, n - 1) * first_speed(); }
  double speed(int n) const { return std::pow(e, n) * first_speed(); }
  /// Time in s of the n-th impact.
  double time(int n) const {
    double t = first_time();
    for (int k = 1; k < n; ++k) t += 2 * speed(k) / gravity;
    return t;
  }
  /// Time in s of the Zeno point, the limit of infinitely many impacts. e < 1.
  double zeno_time() const { return first_time() * (1 + e) / (1 - e); }
  /// Number of impacts until t < zeno_time().
  int impacts(double t) const {
    int n = 0;
    while (time(n + 1) <= t) ++n;
    return n;
  }
  /// Height in m above the plane at t < zeno_time().
  double height(double t) const {
    const int n = impacts(t);
    if (n == 0) return fall - gravity * t * t / 2;
    const double s = t - time(n);
    return speed(n) * s - gravity * s * s / 2;
  }
};

/// A solid sphere that slides on a floor until it rolls; without spin at first, it then has 5/7 of its speed.
/// With backspin it may roll back. Precondition: speed > spin.
struct SlideToRoll {
  double speed, deceleration;  ///< m/s, and mu g in m/s^2
  double spin = 0;             ///< m/s, radius times angular velocity; `speed` if the sphere rolls

  double rolling_at() const { return 2 * (speed - spin) / (7 * deceleration); }  ///< s, start of rolling
  double distance(double t) const {                                              ///< m, travelled
    const double s = std::min(t, rolling_at());
    return speed * s - deceleration * s * s / 2 + (speed - deceleration * s) * (t - s);
  }
};

/// Acceleration in m/s^2 of a sphere down a slope with the given sine and cosine. `k`: moment of inertia over
/// m r^2; 2/5 if it is solid. It rolls if mu >= k/(1 + k) tan, else it slides.
inline double down_slope(double gravity, double sine, double cosine, double mu, double k = 0.4) {
  return mu * cosine >= k / (1 + k) * sine ? gravity * sine / (1 + k) : gravity * (sine - mu * cosine);
}

}  // namespace collidoscope
