#pragma once
// Scenes with many impacts: clusters, racks, rows, gases and piles. Default settings, except for restitution
// and gravity.

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "sim_cuda/scene/scene.h"
#include "tests/gravity.h"
#include "tests/random.h"
#include "tests/scenes.h"

namespace collidoscope {

/// An empty scene with default settings, without gravity unless `gravity` > 0 (downwards, m/s^2).
inline Scene impact_space(double restitution, double gravity = 0) {
  Scene scene;
  scene.name = "impacts";
  scene.physics.gravity = Vector3d(0, 0, -gravity);
  scene.materials[0].restitution = restitution;
  return scene;
}

inline Body ball(double mass, double radius, const Vector3d& position,
                 const Vector3d& velocity = Vector3d(0, 0, 0)) {
  Body body = sphere(radius, position, velocity);
  body.mass = mass;
  return body;
}

template <class Choice>
Choice one_of(Uniform& uniform, std::initializer_list<Choice> choices) {
  return choices.begin()[uniform.random() % choices.size()];
}

inline Vector3d random_direction(Uniform& uniform) {
  Vector3d d(0, 0, 0);
  do d = uniform.vector(1);
  while (d.squaredNorm() > 1 || d.squaredNorm() < 0.01);
  return d.normalized();
}

/// A random number between 1 and `most` whose logarithm is uniform.
inline double random_ratio(Uniform& uniform, double most) { return std::exp(uniform(0, std::log(most))); }

/// 2 to 8 balls of 0.5 m at rest, touching or with gaps, and one ball that hits them within a second.
/// Masses: 1 to `most_mass` kg.
inline Scene ball_cluster(Uniform& uniform, double restitution, double most_mass) {
  Scene scene = impact_space(restitution);
  const std::size_t count = 2 + uniform.random() % 7;
  const double gap = one_of(uniform, {0.0, 1e-3, 1e-2}), speed = one_of(uniform, {2.0, 10.0});
  const bool equal = uniform.random() % 2 == 0;
  std::vector<Vector3d> places{Vector3d(0, 0, 0)};
  Vector3d middle(0, 0, 0);
  for (int attempt = 0; places.size() < count && attempt < 5000; ++attempt) {
    const Vector3d place = places[uniform.random() % places.size()] + (1 + gap) * random_direction(uniform);
    bool is_free = true;
    for (const Vector3d& other : places) is_free = is_free && (place - other).norm() >= 1 + gap - 1e-9;
    if (is_free) places.push_back(place);
  }
  for (const Vector3d& place : places) {
    middle += place / static_cast<double>(places.size());
    scene.bodies.push_back(ball(equal ? 1 : random_ratio(uniform, most_mass), 0.5, place));
  }
  double reach = 0;
  for (const Vector3d& place : places) reach = std::max(reach, (place - middle).norm());
  const Vector3d way = random_direction(uniform);
  const Vector3d aside = way.cross(random_direction(uniform)).normalized();
  scene.bodies.push_back(ball(1, 0.5, middle - (reach + 1.5) * way + uniform(0, 0.8) * aside, speed * way));
  return scene;
}

/// A cue ball at 8 m/s and 15 balls in a triangle with gaps of `gap` m.
inline Scene billiard_rack(double gap, double restitution, int rate = 30) {
  Scene scene = impact_space(restitution);
  scene.physics.time_step = TimeStep::per_second(rate);
  const double r = 0.028575, d = 2 * r + gap;
  scene.bodies.push_back(ball(0.17, r, Vector3d(-0.3, 0, 0), Vector3d(8, 0, 0)));
  for (int row = 0; row < 5; ++row)
    for (int k = 0; k <= row; ++k)
      scene.bodies.push_back(ball(0.17, r, Vector3d(row * d * std::sqrt(3.0) / 2, (k - row / 2.0) * d, 0)));
  return scene;
}

/// A row of balls of 0.1 m along x, of which the first `incoming` arrive at 2 m/s. Elastic.
inline Scene row_of_balls(int count, int incoming, double gap = 0) {
  Scene scene = impact_space(1);
  const double r = 0.1;
  for (int i = 0; i < incoming; ++i)
    scene.bodies.push_back(ball(1, r, Vector3d(-(incoming - i) * 2 * r - 0.5, 0, 0), Vector3d(2, 0, 0)));
  for (int i = 0; i < count - incoming; ++i)
    scene.bodies.push_back(ball(1, r, Vector3d(i * (2 * r + gap), 0, 0)));
  return scene;
}

/// `count` balls of 0.5 m and 1 kg that fill the share `fill` of a cubic box, near the points of a lattice.
inline Scene gas_lattice(Uniform& uniform, int count, double fill, double speed, double restitution) {
  Scene scene = impact_space(restitution);
  const int side = static_cast<int>(std::ceil(std::cbrt(count) - 1e-9));
  const double length = std::cbrt(count * 0.5235987755982988 / fill), cell = length / side;
  for (int c = 0; c < count; ++c) {
    const Vector3d corner(c / (side * side), c / side % side, c % side);
    scene.bodies.push_back(ball(1, 0.5,
                                cell * (corner + Vector3d(0.5, 0.5, 0.5)) + uniform.vector(0.45 * (cell - 1)),
                                uniform.vector(speed)));
  }
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(length, length, length)};
  return scene;
}

/// `count` balls of 0.3 to 0.6 m in layers of `side` x `side` that fall into a shaft.
inline Scene falling_pile(Uniform& uniform, int count, int side, double restitution) {
  Scene scene = impact_space(restitution, g);
  const double cell = 4.0 / 3;
  for (int c = 0; c < count; ++c) {
    const int layer = c / (side * side), i = c / side % side, j = c % side;
    const Vector3d place(cell * (i + 0.5) + uniform(-0.05, 0.05), cell * (j + 0.5) + uniform(-0.05, 0.05),
                         1 + 1.35 * layer);
    scene.bodies.push_back(sphere(uniform(0.3, 0.6), place, uniform.vector(2)));
  }
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(cell * side, cell * side, 1000)};
  return scene;
}

}  // namespace collidoscope
