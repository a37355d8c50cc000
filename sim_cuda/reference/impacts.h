#pragma once
// Impacts, rebounds, sliding and rolling of spheres by the laws of Newton and Coulomb, in closed form. SI
// units; free functions.

#include <algorithm>
#include <cmath>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

struct TwoVelocities {
  Vector3d a, b;  ///< m/s
};

/// After a frictionless impact along `normal` (unit, from a to b) with the coefficient e: momentum is kept,
/// and they part along the normal at e times the speed at which they met.
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

/// After a solid sphere meets a plane (unit normal): the surface at the contact comes to rest if Coulomb's
/// cone allows it (2/7 of the slip is taken from the centre), else all that mu (1 + e) allows is taken.
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

/// A ball that is dropped through `fall` m onto a plane, again and again with the coefficient e.
struct Rebounds {
  double gravity, fall, e;  ///< m/s^2, m, 0 to 1

  double first_speed() const { return std::sqrt(2 * gravity * fall); }  ///< m/s, at the plane
  double first_time() const { return std::sqrt(2 * fall / gravity); }   ///< s
  /// m/s, leaving the plane for the n-th time, n >= 1.
  double speed(int n) const { return std::pow(e, n) * first_speed(); }
  /// s, of the n-th impact.
  double time(int n) const {
    double t = first_time();
    for (int k = 1; k < n; ++k) t += 2 * speed(k) / gravity;
    return t;
  }
  /// s, of the last of infinitely many impacts: Zeno's point; e < 1.
  double zeno_time() const { return first_time() * (1 + e) / (1 - e); }
  /// How often it has met the plane by t < zeno_time().
  int impacts(double t) const {
    int n = 0;
    while (time(n + 1) <= t) ++n;
    return n;
  }
  /// m above the plane at t < zeno_time().
  double height(double t) const {
    const int n = impacts(t);
    if (n == 0) return fall - gravity * t * t / 2;
    const double s = t - time(n);
    return speed(n) * s - gravity * s * s / 2;
  }
};

/// A solid sphere thrown along the floor without spin at v0 m/s: it slides, until it rolls at 5/7 v0.
struct SlideToRoll {
  double speed, deceleration;  ///< m/s, and mu g in m/s^2

  double rolling_at() const { return 2 * speed / (7 * deceleration); }  ///< s
  double distance(double t) const {                                     ///< m
    const double s = std::min(t, rolling_at());
    return speed * s - deceleration * s * s / 2 + 5.0 / 7 * speed * (t - s);
  }
};

/// m/s^2, of a solid sphere down a slope whose sine and cosine are given: it rolls where mu >= 2/7 tan.
inline double down_slope(double gravity, double sine, double cosine, double mu) {
  return mu * cosine >= 2.0 / 7 * sine ? 5.0 / 7 * gravity * sine : gravity * (sine - mu * cosine);
}

}  // namespace collidoscope
