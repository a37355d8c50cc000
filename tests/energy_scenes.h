#pragma once
// Random scenes for property tests of the energy. The settings are the defaults.

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "tests/impact_scenes.h"

namespace collidoscope {

inline double any_restitution(Uniform& uniform) {
  return one_of(uniform, {1.0, 0.9, 0.5, 0.0, uniform(0, 1)});
}

inline Scene any_gas(Uniform& uniform) {
  Scene scene =
      gas_lattice(uniform, 64, uniform(0.02, 0.4), random_ratio(uniform, 100), any_restitution(uniform));
  const double ratio = one_of(uniform, {1.0, 100.0});
  for (Body& body : scene.bodies) body.mass = random_ratio(uniform, ratio);
  return scene;
}

inline Scene any_pile(Uniform& uniform) { return falling_pile(uniform, 40, 3, any_restitution(uniform)); }

/// 45 layers of equal balls fall in a shaft.
inline Scene tall_pile(Uniform& uniform) {
  Scene scene = impact_space(0.5, g);
  constexpr int side = 4, layers = 45;
  constexpr double cell = 1.05;
  const auto shake = [&] { return uniform(-0.02, 0.02); };
  for (int c = 0; c < layers * side * side; ++c)
    scene.bodies.push_back(
        sphere(0.5, Vector3d{cell * (c / side % side + 0.5) + shake(), cell * (c % side + 0.5) + shake(),
                             0.6 + 1.1 * (c / (side * side)) + shake()}));
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(cell * side, cell * side, 1000)};
  return scene;
}

/// Balls fall in a shaft, one above the other, with gaps of 1 mm to 1 m. With small gaps, several balls are
/// stopped in one step.
inline Scene falling_column(Uniform& uniform) {
  Scene scene = impact_space(any_restitution(uniform), g);
  scene.materials[0].friction = one_of(uniform, {0.0, 0.5});
  const int count = 2 + static_cast<int>(uniform.random() % 29);
  const double gap = random_ratio(uniform, 1000) / 1000, speed = uniform(1, 10);
  double height = 0;
  for (int k = 0; k < count; ++k) {
    const double radius = uniform(0.4, 0.5);
    height += radius + gap;
    scene.bodies.push_back(
        sphere(radius, Vector3d(0.55 + (k % 2 == 0 ? 0.04 : -0.04), 0.55 + uniform(-0.02, 0.02), height),
               Vector3d(0, 0, -speed)));
    height += radius;
  }
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(1.1, 1.1, 1000)};
  return scene;
}

/// A heavy ball falls on balls in a shaft.
inline Scene heavy_on_pile(Uniform& uniform) {
  Scene scene = impact_space(any_restitution(uniform), g);
  const int count = 5 + static_cast<int>(uniform.random() % 36);
  for (int c = 0; c < count; ++c)
    scene.bodies.push_back(
        ball(1, 0.5,
             Vector3d(1.05 * (c % 4 + 0.5) + uniform(-0.02, 0.02),
                      1.05 * (c / 4 % 4 + 0.5) + uniform(-0.02, 0.02), 0.5 + 1.01 * (c / 16))));
  scene.bodies.push_back(ball(random_ratio(uniform, 1e4), 1,
                              Vector3d(2.1 + uniform(-0.5, 0.5), 2.1 + uniform(-0.5, 0.5), uniform(5, 8)),
                              Vector3d(0, 0, uniform(-5, -1))));
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(4.2, 4.2, 1000)};
  return scene;
}

/// Spinning balls with friction fall on a slope and a fixed ball.
inline Scene rough_pile(Uniform& uniform) {
  Scene scene = any_pile(uniform);
  scene.materials[0].friction = random_ratio(uniform, 100) / 100;
  for (Body& body : scene.bodies) {
    body.position.z() += 1.5;
    body.angular_velocity = uniform.vector(20);
  }
  scene.obstacles = {Plane{Vector3d(0.6, 0, 0.8), 0.5, 0}};
  Body fixed = sphere(0.7, Vector3d(2.5, 2.5, 0.7));
  fixed.motion = Motion::fixed;
  scene.bodies.push_back(fixed);
  return scene;
}

/// Spinning balls fly at a large ball from all sides, or fall on it. It has more contacts than there are
/// colours, so some are mass-split.
inline Scene many_on_one(Uniform& uniform) {
  const bool falling = uniform.random() % 2 == 0;
  Scene scene = impact_space(any_restitution(uniform), falling ? g : 0);
  scene.materials[0].friction = one_of(uniform, {0.0, random_ratio(uniform, 100) / 100});
  const double large = uniform(2.5, 4), small = 0.3;
  const int count = 60 + static_cast<int>(uniform.random() % 60);
  scene.bodies.push_back(ball(random_ratio(uniform, 1e4), large, Vector3d(0, 0, 0)));
  const double mass = random_ratio(uniform, 1e3);
  for (int c = 0; c < count; ++c) {
    const double z = falling ? (c + 0.5) / count : 2 * (c + 0.5) / count - 1, angle = 2.399963 * c;
    const Vector3d away(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    scene.bodies.push_back(ball(mass, small, (large + small + uniform(0.001, 0.05)) * away,
                                uniform.vector(1) - uniform(0, 3) * away));
    scene.bodies.back().angular_velocity = uniform.vector(20);
  }
  if (falling) scene.obstacles = {Plane{Vector3d(0, 0, 1), -large, 0}};
  return scene;
}

inline Scene rolling_pile(Uniform& uniform) {
  Scene scene = rough_pile(uniform);
  scene.materials[0].rolling_resistance = uniform(0, 0.3);
  return scene;
}

/// Oblate, flat, prolate, asymmetric, slender and nearly spherical bodies in any orientation.
inline void set_inertias(Scene& scene, Uniform& uniform) {
  for (Body& body : scene.bodies) {
    const double squared = body.radius * body.radius;
    if (!body.mass) body.mass = 4190 * squared * body.radius;
    const Vector3d shape =
        one_of(uniform, {Vector3d(1, 1, 1.9), Vector3d(1, 1, 2), Vector3d(1, 1, 0.3), Vector3d(1, 1.7, 2.5),
                         Vector3d(1, 1, 1e-3), Vector3d(1, 1.001, 1.002)});
    body.inertia = *body.mass * squared * uniform(0.05, 0.2) * shape;
    const Vector3d axis = random_direction(uniform);
    const double angle = uniform(0, std::numbers::pi);
    body.orientation = Quaterniond(std::cos(angle / 2), std::sin(angle / 2) * axis.x(),
                                   std::sin(angle / 2) * axis.y(), std::sin(angle / 2) * axis.z());
    body.orientation.coeffs() /= std::sqrt(body.orientation.squaredNorm());
  }
}

/// The spheres of `scene` are up to 1.4 times as large.
inline Scene enlarged(Scene scene, Uniform& uniform) {
  for (Body& body : scene.bodies) body.radius *= uniform(1, 1.4);
  if (scene.physics.gravity.z() == 0) scene.box.reset();
  return scene;
}

/// Makes all bodies a rigid one that rotates about the origin.
inline void rotate_all(Scene& scene, const Vector3d& angular_velocity) {
  for (Body& body : scene.bodies) {
    body.angular_velocity = angular_velocity;
    body.velocity = angular_velocity.cross(body.position);
  }
}
/// Joins body `a` at the world position `place` to body `b`, or to the world.
inline Joint joint_at(const Scene& scene, JointKind kind, std::int64_t a, std::optional<std::int64_t> b,
                      const Vector3d& place) {
  const Body& body = scene.bodies[static_cast<std::size_t>(a)];
  Joint joint;
  joint.kind = kind;
  joint.a = a;
  joint.b = b;
  const bool line = kind == JointKind::distance || kind == JointKind::spring;
  if (line && !b) joint.anchor_b = place;
  if (!line) joint.anchor_a = body.orientation.conjugate() * Vector3d(place - body.position);
  joint.axis = body.orientation.conjugate() * Vector3d(0, 1, 0);
  joint.axis /= std::sqrt(joint.axis.squaredNorm());
  return joint;
}

/// A chain from the origin, or a ring through it, in the plane y = 0 that swings about it.
inline Scene any_chain(Uniform& uniform, JointKind kind, bool ring, double most_ratio) {
  Scene scene = impact_space(0, g);
  const int count =
      ring ? 3 + static_cast<int>(uniform.random() % 8) : 1 + static_cast<int>(uniform.random() % 10);
  const double start = uniform(0, 2 * std::numbers::pi);
  Vector3d place(0, 0, 0);
  std::vector<Vector3d> ends{place};
  for (int k = 0; k < count; ++k) {
    const double angle = ring ? start + 2 * std::numbers::pi * k / count : start + uniform(-0.5, 0.5);
    const Vector3d link = (ring ? 0.8 : uniform(0.6, 1)) * Vector3d(std::cos(angle), 0, std::sin(angle));
    scene.bodies.push_back(ball(random_ratio(uniform, 2), 0.2, place + link / 2));
    place += link;
    ends.push_back(place);
  }
  scene.bodies.back().mass = random_ratio(uniform, most_ratio);
  if (kind != JointKind::distance && uniform.random() % 2 == 0) set_inertias(scene, uniform);
  for (int k = 0; k < count; ++k)
    scene.joints.push_back(joint_at(scene, kind, k, k > 0 ? std::optional<std::int64_t>(k - 1) : std::nullopt,
                                    ends[static_cast<std::size_t>(k)]));
  if (ring) scene.joints.push_back(joint_at(scene, kind, count - 1, 0, place));
  rotate_all(scene, Vector3d(0, uniform(0.5, 4), 0));
  return scene;
}

/// A tree of up to 16 bodies from the origin; each body hangs from any earlier one, in any direction.
inline Scene any_tree(Uniform& uniform, JointKind kind, double most_ratio) {
  Scene scene = impact_space(0, g);
  const int count = 2 + static_cast<int>(uniform.random() % 15);
  std::vector<Vector3d> ends{Vector3d(0, 0, 0)};
  std::vector<std::size_t> parents;
  for (int k = 0; k < count; ++k) {
    parents.push_back(uniform.random() % ends.size());
    const Vector3d link = uniform(0.4, 1) * random_direction(uniform), place = ends[parents.back()];
    scene.bodies.push_back(ball(random_ratio(uniform, most_ratio), 0.1, place + link / 2, uniform.vector(2)));
    scene.bodies.back().angular_velocity = uniform.vector(3);
    ends.push_back(place + link);
  }
  if (kind != JointKind::distance && uniform.random() % 2 == 0) set_inertias(scene, uniform);
  const bool hangs = uniform.random() % 2 == 0;
  for (std::size_t k = 0; k < parents.size(); ++k) {
    const bool first = parents[k] == 0;
    if (first && (k > 0 || !hangs)) continue;
    scene.joints.push_back(joint_at(scene, kind, static_cast<std::int64_t>(k),
                                    first ? std::nullopt : std::optional<std::int64_t>(parents[k] - 1),
                                    ends[parents[k]]));
  }
  for (Body& body : scene.bodies) body.radius = 0.02;
  return scene;
}

/// A net of rods in the plane z = 0, with random velocities. It hangs from two corners, or flies. Some rods
/// are up to `longer` longer than the distance of their bodies.
inline Scene any_net(Uniform& uniform, double longer, int most_columns = 6, int most_rows = 4) {
  Scene scene = impact_space(0, g);
  const auto up_to = [&](int most) {
    return 2 + static_cast<int>(uniform.random() % static_cast<std::uint32_t>(most - 1));
  };
  const int columns = up_to(most_columns), rows = up_to(most_rows);
  const double spacing = uniform(0.3, 1);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      scene.bodies.push_back(
          ball(random_ratio(uniform, 3), 0.05, spacing * Vector3d(column, row, 0), uniform.vector(1)));
  const auto rod = [&](int a, int b) {
    Joint joint;
    joint.kind = JointKind::distance;
    joint.a = a;
    joint.b = b;
    if (uniform.random() % 2 == 0) joint.length = spacing * uniform(1, 1 + longer);
    scene.joints.push_back(joint);
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const int body = row * columns + column;
      if (column + 1 < columns) rod(body, body + 1);
      if (row + 1 < rows) rod(body, body + columns);
    }
  if (uniform.random() % 3 > 0)
    for (const int corner : {0, columns - 1})
      scene.joints.push_back(joint_at(scene, JointKind::ball, corner, std::nullopt,
                                      scene.bodies[static_cast<std::size_t>(corner)].position));
  return scene;
}

/// Adds up to `most` springs between any bodies.
inline void add_springs(Scene& scene, Uniform& uniform, int most) {
  const auto count = static_cast<std::uint32_t>(scene.bodies.size());
  for (int k = 0; k < most; ++k) {
    const std::int64_t a = uniform.random() % count, b = uniform.random() % count;
    if (a == b) continue;
    Joint joint;
    joint.kind = JointKind::spring;
    joint.a = a;
    joint.b = b;
    joint.frequency = uniform(0.2, 3);
    joint.damping_ratio = uniform(0, 0.5);
    scene.joints.push_back(joint);
  }
}

/// A floor 0.5 m below the lowest body.
inline void add_floor(Scene& scene, Uniform& uniform) {
  double lowest = 0;
  for (const Body& body : scene.bodies) lowest = std::min(lowest, body.position.z());
  scene.obstacles = {Plane{Vector3d(0, 0, 1), lowest - 0.5, 0}};
  scene.materials[0].friction = one_of(uniform, {0.0, 0.5});
}

inline JointKind any_rigid_kind(Uniform& uniform) {
  return one_of(uniform, {JointKind::distance, JointKind::ball, JointKind::hinge});
}

/// Overlapping bodies at rest, and a ball far away. Its kinetic energy is that of the bodies at ten radii per
/// second, the largest speed of the recovery.
inline Scene overlap_at_rest(Uniform& uniform) {
  Scene scene = enlarged(any_gas(uniform), uniform);
  scene.physics.gravity = Vector3d(0, 0, 0);
  scene.box.reset();
  scene.materials[0].friction = one_of(uniform, {0.0, 0.5});
  double energy = 0;
  for (Body& body : scene.bodies) {
    body.velocity = Vector3d(0, 0, 0);
    energy += *body.mass / 2 * std::pow(10 * body.radius, 2);
  }
  scene.bodies.push_back(ball(2 * energy, 0.1, Vector3d(0, 0, 1000), Vector3d(0, 0, 1)));
  return scene;
}

}  // namespace collidoscope
