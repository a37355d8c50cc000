#include "headless/bench/growth.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace collidoscope {
namespace {

/// Best fit for a given exponent. The other two parameters follow from linear least squares of fixed / t +
/// scale * n^p / t against 1.
Growth with_exponent(const std::vector<Sample>& samples, double exponent) {
  double aa = 0, ab = 0, bb = 0, a1 = 0, b1 = 0;
  for (const Sample& s : samples) {
    const double a = 1 / s.time, b = std::pow(s.n, exponent) / s.time;
    aa += a * a;
    ab += a * b;
    bb += b * b;
    a1 += a;
    b1 += b;
  }
  Growth fit;
  fit.exponent = exponent;
  const double determinant = aa * bb - ab * ab;
  if (determinant > 1e-12 * aa * bb) {
    fit.fixed = (a1 * bb - b1 * ab) / determinant;
    fit.scale = (b1 * aa - a1 * ab) / determinant;
  }
  if (!(fit.fixed > 0) || !(fit.scale > 0)) {
    fit.fixed = 0;
    fit.scale = b1 / bb;
  }
  double squares = 0;
  for (const Sample& s : samples) {
    const double residual = (s.time - fit.at(s.n)) / s.time;
    squares += residual * residual;
  }
  fit.error = std::sqrt(squares / static_cast<double>(samples.size()));
  return fit;
}

Growth best(const std::vector<Sample>& samples) {
  constexpr double least = 0.05, most = 3, step = 0.05;
  Growth result = with_exponent(samples, least);
  for (double p = least + step; p <= most + 1e-9; p += step)
    if (const Growth fit = with_exponent(samples, p); fit.error < result.error) result = fit;
  // Refines the search around the best coarse exponent (ternary search).
  double low = std::max(least, result.exponent - step), high = std::min(most, result.exponent + step);
  for (int round = 0; round < 40; ++round) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (with_exponent(samples, a).error < with_exponent(samples, b).error)
      high = b;
    else
      low = a;
  }
  const Growth fine = with_exponent(samples, (low + high) / 2);
  return fine.error < result.error ? fine : result;
}

}  // namespace

double Growth::at(double n) const { return fixed + scale * std::pow(n, exponent); }

Growth fit_growth(const std::vector<Sample>& samples) {
  std::set<double> sizes;
  for (const Sample& s : samples) sizes.insert(s.n);
  if (sizes.size() < 4) return {};
  Growth fit = best(samples);
  fit.exponent_least = fit.exponent_most = fit.exponent;
  for (std::size_t left_out = 0; left_out < samples.size(); ++left_out) {
    std::vector<Sample> others = samples;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
    const double exponent = best(others).exponent;
    fit.exponent_least = std::min(fit.exponent_least, exponent);
    fit.exponent_most = std::max(fit.exponent_most, exponent);
  }
  return fit;
}

}  // namespace collidoscope
