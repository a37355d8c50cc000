#include "sim_cuda/reference/kepler.h"

#include <cmath>
#include <numbers>

namespace collidoscope {
namespace {

/// Semi-major axis in m.
double half_axis(double mu, const OrbitState& s) {
  return 1 / (2 / s.position.norm() - s.velocity.squaredNorm() / mu);
}

}  // namespace

double kepler_period(double mu, const OrbitState& start) {
  const double a = half_axis(mu, start);
  return 2 * std::numbers::pi * std::sqrt(a * a * a / mu);
}

OrbitState kepler_orbit(double mu, const OrbitState& start, double t) {
  const double r0 = start.position.norm(), a = half_axis(mu, start), n = std::sqrt(mu / (a * a * a));
  const double e_cos = 1 - r0 / a, e_sin = start.position.dot(start.velocity) / std::sqrt(mu * a);
  double turn = n * t;  // difference of eccentric anomalies
  for (int k = 0; k < 50; ++k) {
    const double miss = turn - e_cos * std::sin(turn) + e_sin * (1 - std::cos(turn)) - n * t;
    const double step = miss / (1 - e_cos * std::cos(turn) + e_sin * std::sin(turn));
    turn -= step;
    if (std::abs(step) < 1e-15 * (1 + std::abs(turn))) break;
  }
  const double c = std::cos(turn), s = std::sin(turn), r = a * (1 - e_cos * c + e_sin * s);
  const double f = 1 - a / r0 * (1 - c), g = t - (turn - s) / n;
  const double df = -std::sqrt(mu * a) / (r * r0) * s, dg = 1 - a / r * (1 - c);
  return {f * start.position + g * start.velocity, df * start.position + dg * start.velocity};
}

}  // namespace collidoscope
