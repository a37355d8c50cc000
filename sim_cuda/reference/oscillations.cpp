#include "sim_cuda/reference/oscillations.h"

#include <cmath>

#include "sim_cuda/reference/jacobi_elliptic.h"

namespace collidoscope {

Oscillation damped_oscillation(double w, double z, double t) {
  const double decay = std::exp(-z * w * t), square = 1 - z * z;
  if (square == 0) return {decay * (1 + w * t), -decay * w * w * t};
  const double r = w * std::sqrt(std::abs(square));
  const double c = square > 0 ? std::cos(r * t) : std::cosh(r * t);
  const double s = square > 0 ? std::sin(r * t) : std::sinh(r * t);
  return {decay * (c + z * w / r * s), -decay * w * w / r * s};
}

Oscillation pendulum(double w, double amplitude, double t) {
  const double k = std::sin(amplitude / 2), m = k * k;
  const JacobiElliptic e = jacobi_elliptic(w * t + complete_elliptic(m), m);
  return {2 * std::asin(k * e.sn), 2 * k * w * e.cn};
}

double pendulum_period(double w, double amplitude) {
  const double k = std::sin(amplitude / 2);
  return 4 * complete_elliptic(k * k) / w;
}

}  // namespace collidoscope
