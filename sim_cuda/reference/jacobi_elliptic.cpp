#include "sim_cuda/reference/jacobi_elliptic.h"

#include <array>
#include <cmath>
#include <numbers>

namespace collidoscope {
namespace {

/// Means a_n and halved differences c_n. Convergence is quadratic: ten iterations exceed the precision of
/// double.
struct ArithmeticGeometricMean {
  std::array<double, 10> a{}, c{};
  int last = 0;

  explicit ArithmeticGeometricMean(double m) {
    double b = std::sqrt(1 - m);
    a[0] = 1;
    c[0] = std::sqrt(m);
    while (std::abs(c[static_cast<std::size_t>(last)]) > 1e-17 && last + 1 < static_cast<int>(a.size())) {
      const double before = a[static_cast<std::size_t>(last)];
      ++last;
      a[static_cast<std::size_t>(last)] = (before + b) / 2;
      c[static_cast<std::size_t>(last)] = (before - b) / 2;
      b = std::sqrt(before * b);
    }
  }
};

}  // namespace

double complete_elliptic(double m) {
  const ArithmeticGeometricMean means(m);
  return std::numbers::pi / 2 / means.a[static_cast<std::size_t>(means.last)];
}

JacobiElliptic jacobi_elliptic(double u, double m) {
  const ArithmeticGeometricMean means(m);
  double phi = std::ldexp(means.a[static_cast<std::size_t>(means.last)] * u, means.last);
  for (auto n = static_cast<std::size_t>(means.last); n > 0; --n)
    phi = (phi + std::asin(means.c[n] / means.a[n] * std::sin(phi))) / 2;
  const double cn = std::cos(phi);
  return {std::sin(phi), cn, std::sqrt(1 - m + m * cn * cn)};
}

}  // namespace collidoscope
