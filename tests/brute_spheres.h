#pragma once
// Brute-force elastic hard spheres in a box, the expected values for the event-driven reference. The code is
// independent of the reference: textbook formulas in long double. Every event moves all spheres, and the next
// event is the minimum over all pairs.
// Also the expected values for the time-stepped gas: with `step`, a collision changes the velocities early,
// at the start of the first step of `step` s in which the spheres would touch within 17/16 of it (walls: see
// longer_reach()).

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim_cuda/reference/hard_spheres.h"

namespace collidoscope {

class BruteSpheres {
 public:
  using Real = long double;
  using Vector = Vector3<Real>;
  static constexpr Real infinite = std::numeric_limits<Real>::infinity();

  BruteSpheres(const Scene& scene, const InitialBodies& bodies, Real step = 0)
      : step_(step),
        gravity_(scene.physics.gravity.cast<Real>()),
        box_(*bodies.box),
        mass_(bodies.mass),
        radius_(bodies.radius) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      x_.push_back(bodies.position[i].cast<Real>());
      v_.push_back(bodies.velocity[i].cast<Real>());
    }
    on_face_.assign(x_.size(), faces);
    times_.assign(x_.size() * (x_.size() + faces), infinite);
    for (std::size_t i = 0; i < x_.size(); ++i) renew(i);
  }

  /// Advances to the next collision.
  CollisionEvent next() {
    const std::size_t first = static_cast<std::size_t>(std::ranges::min_element(times_) - times_.begin());
    const std::size_t row = x_.size() + faces, a = first / row, b = first % row;
    fly_to(impact_time(times_[first]));
    CollisionEvent done{static_cast<double>(time_), static_cast<std::uint32_t>(a), no_body, 0, {}, 0};
    if (b < x_.size()) {
      done.other = static_cast<std::uint32_t>(b);
      const Vector n = (x_[a] - x_[b]).normalized();
      const Real impulse = 2 * n.dot(v_[b] - v_[a]) / (1 / Real(mass_[a]) + 1 / Real(mass_[b]));
      v_[a] += impulse / mass_[a] * n;
      v_[b] -= impulse / mass_[b] * n;
      on_face_[a] = on_face_[b] = faces;
      renew(b);
    } else {
      done.plane = static_cast<std::uint32_t>(b - x_.size());
      v_[a][static_cast<int>(done.plane / 2)] *= -1;
      on_face_[a] = done.plane;
    }
    renew(a);
    return done;
  }
  /// Advances to `time`, without the collisions at this time.
  void advance_to(Real time) {
    while (impact_time(*std::ranges::min_element(times_)) < time) next();
    fly_to(time);
  }
  const std::vector<Vector>& positions() const { return x_; }

 private:
  static constexpr std::size_t faces = 6;

  Real impact_time(Real contact) const {
    return step_ > 0 ? std::max(time_, step_ * std::floor(contact / step_ - Real(1) / 16)) : contact;
  }
  void fly_to(Real time) {
    const Real dt = time - time_;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      x_[i] += dt * v_[i] + dt * dt / 2 * gravity_;
      v_[i] += dt * gravity_;
    }
    time_ = time;
  }

  Real pair_time(std::size_t a, std::size_t b) const {
    const Vector d = x_[b] - x_[a], v = v_[b] - v_[a];
    const Real reach = Real(radius_[a]) + Real(radius_[b]), half = d.dot(v), square = v.squaredNorm();
    const Real root = half * half - square * (d.squaredNorm() - reach * reach);
    return half < 0 && root >= 0 ? time_ - (half + std::sqrt(root)) / square : Real(infinite);
  }
  Real face_time(std::size_t i, std::size_t face) const {
    const int axis = static_cast<int>(face / 2);
    const Real sign = face % 2 ? -1 : 1, wall = face % 2 ? box_.max[axis] : box_.min[axis];
    const Real v = sign * v_[i][axis], g = sign * gravity_[axis];
    const Real gap = on_face_[i] == face && step_ == 0 ? 0 : sign * (x_[i][axis] - wall) - Real(radius_[i]);
    if (g == 0) return v < 0 ? time_ - gap / v : Real(infinite);
    const Real root = v * v - 2 * g * gap;
    if (root < 0) return infinite;
    for (const Real t : {(-v - std::sqrt(root)) / std::abs(g) * (g < 0 ? -1 : 1),
                         (-v + std::sqrt(root)) / std::abs(g) * (g < 0 ? -1 : 1)})
      if (t >= 0 && v + g * t < 0) return time_ + t - (step_ > 0 && g < 0 ? longer_reach(-v - g * t, -g) : 0);
    return infinite;
  }
  /// Time by which an impact at a wall is earlier than 17/16 of a step if gravity `g`, m/s^2, pulls towards
  /// the wall. The sphere arrives at `speed`, m/s, and at time t before, its speed is v = speed - g t. The
  /// step is the first one that starts closer to the wall than 17/16 step (v + g step), as Euler's method
  /// moves it.
  Real longer_reach(Real speed, Real g) const {
    const Real reach = Real(17) / 16 * step_, b = speed + reach * g;
    return (b - std::sqrt(b * b - 2 * g * reach * (speed + g * step_))) / g - reach;
  }
  void renew(std::size_t i) {
    const std::size_t row = x_.size() + faces;
    for (std::size_t j = 0; j < x_.size(); ++j)
      if (i != j) times_[std::min(i, j) * row + std::max(i, j)] = pair_time(i, j);
    for (std::size_t face = 0; face < faces; ++face) times_[i * row + x_.size() + face] = face_time(i, face);
  }

  Real step_;
  Vector gravity_;
  Box box_;
  std::vector<double> mass_, radius_;
  std::vector<Vector> x_, v_;
  std::vector<std::size_t> on_face_;  // the face of the last bounce, by body
  std::vector<Real> times_;           // body with body, then body with face
  Real time_ = 0;
};

}  // namespace collidoscope
