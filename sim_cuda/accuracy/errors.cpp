#include "sim_cuda/accuracy/errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_cuda/accuracy/point.h"

namespace collidoscope {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

bool moves(const InitialBodies& bodies, std::size_t id) {
  return bodies.motion.empty() || bodies.motion[id] == Motion::dynamic;
}

}  // namespace

std::vector<double> squared_distances(const BodyStates& a, const BodyStates& b, const InitialBodies& bodies,
                                      bool turning) {
  std::vector<double> squares(bodies.size(), 0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!moves(bodies, i)) continue;
    double square = (a.position[i] - b.position[i]).squaredNorm();
    if (turning) {
      const double r = bodies.radius[i];
      const Vector3d spread =  // m^2, principal moments over the mass
          bodies.inertia.empty() ? Vector3d(0.4 * r * r, 0.4 * r * r, 0.4 * r * r)
                                 : Vector3d(bodies.inertia[i] / bodies.mass[i]);
      const Vector3d half = 2 * (b.orientation[i].conjugate() * a.orientation[i]).vec();
      square += half.cwiseProduct(half).dot(spread);
    }
    squares[i] = std::isfinite(square) ? square : infinite;
  }
  return squares;
}

void ErrorSum::add(const std::vector<double>& squares) {
  sum_.resize(squares.size(), 0);
  for (std::size_t i = 0; i < squares.size(); ++i) {
    sum_[i] += squares[i];
    worst_ = std::max(worst_, std::sqrt(squares[i]));
  }
  ++states_;
}

ErrorSum::Result ErrorSum::result(const InitialBodies& bodies) const {
  constexpr std::size_t groups = 16;
  double sum = 0, sums[groups] = {};
  std::size_t count = 0, counts[groups] = {};
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    if (!moves(bodies, i)) continue;
    const std::size_t group = count++ % groups;
    ++counts[group];
    sum += sum_[i];
    sums[group] += sum_[i];
  }
  if (count == 0 || states_ == 0) return {0, 0, 0, 0};
  const double mean = sum / (static_cast<double>(count) * states_);
  double scatter = 0, used = 0;
  for (std::size_t k = 0; k < groups; ++k) {
    if (counts[k] == 0) continue;
    const double off = sums[k] / (static_cast<double>(counts[k]) * states_) - mean;
    scatter += off * off;
    ++used;
  }
  const double off = used > 1 ? std::sqrt(scatter / (used * (used - 1))) : 0;
  return {std::sqrt(mean), std::sqrt(std::max(mean - off, 0.0)), std::sqrt(mean + off), worst_};
}

double rms_distance(const BodyStates& a, const BodyStates& b, const InitialBodies& bodies, bool turning) {
  ErrorSum sum;
  sum.add(squared_distances(a, b, bodies, turning));
  return sum.result(bodies).rms;
}

double distribution_distance(std::vector<double> a, std::vector<double> b) {
  std::ranges::sort(a);
  std::ranges::sort(b);
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += std::abs(a[k] - b[k]);
  return std::isfinite(sum) ? sum / static_cast<double>(std::max<std::size_t>(a.size(), 1)) : infinite;
}

double fitted_order(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.size() < 2 || x.size() != y.size()) return not_known;
  const auto n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    mean_x += std::log(x[k]) / n;
    mean_y += std::log(y[k]) / n;
  }
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double dx = std::log(x[k]) - mean_x;
    xx += dx * dx;
    xy += dx * (std::log(y[k]) - mean_y);
  }
  return xy / xx;
}

}  // namespace collidoscope
