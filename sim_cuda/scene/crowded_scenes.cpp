#include "sim_cuda/scene/crowded_scenes.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "sim_cuda/core/philox.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

constexpr double ball = 4 * std::numbers::pi / 3;  // m^3, volume of a sphere of radius 1 m
constexpr double fill = 0.3;
constexpr std::uint32_t position_stream = 0, radius_stream = 1, cluster_stream = 2;

std::array<double, 3> uniform(std::uint64_t seed, std::int64_t id, std::uint32_t stream) {
  const PhiloxWords r = philox4x32({{static_cast<std::uint32_t>(id), stream, 0, 0}}, philox_key(seed));
  return {static_cast<double>(unit_float(r.w[0])), static_cast<double>(unit_float(r.w[1])),
          static_cast<double>(unit_float(r.w[2]))};
}

/// Approximately normal number: the sum of 12 uniform numbers minus 6. Mean 0, variance 1.
double normal(std::uint64_t seed, std::int64_t id) {
  double sum = -6;
  for (std::uint32_t k = 0; k < 4; ++k)
    for (const double u : uniform(seed, id, radius_stream << 8 | k)) sum += u;
  return sum;
}

double exponential(double x) {
  double power = 1 + x / 65536 + x * x / (2.0 * 65536 * 65536);
  for (int k = 0; k < 16; ++k) power *= power;
  return power;
}

/// A position in the cube [low, low + side]^3, at least `margin` from its faces.
Vector3d place(const Vector3d& low, double side, double margin, const std::array<double, 3>& u) {
  const double room = std::max(side - 2 * margin, 0.0);
  return low + Vector3d(margin + room * u[0], margin + room * u[1], margin + room * u[2]);
}

double side_for(double volume) { return newton_cube_root(volume / fill); }

Body sphere(double radius, const Vector3d& position) {
  Body body;
  body.radius = radius;
  body.position = position;
  return body;
}

struct Bodies {
  std::vector<Body> bodies;
  double side = 1;  ///< m, side of the box
};

Bodies mixed(std::int64_t count, std::uint64_t seed) {
  constexpr double large = 1, small = 0.001;
  const std::int64_t larger = count / 2;
  Bodies all;
  all.side = std::max(side_for(static_cast<double>(larger) * ball), 4 * large);
  const double corner = side_for(static_cast<double>(count - larger) * ball * small * small * small);
  for (std::int64_t id = 0; id < count; ++id) {
    const bool is_large = id % 2 == 1;
    const double radius = is_large ? large : small;
    all.bodies.push_back(sphere(radius, place(Vector3d(0, 0, 0), is_large ? all.side : corner, radius,
                                              uniform(seed, id, position_stream))));
  }
  return all;
}

Bodies log_normal(std::int64_t count, std::uint64_t seed) {
  Bodies all;
  double volume = 0, largest = 0;
  std::vector<double> radii;
  for (std::int64_t id = 0; id < count; ++id) {
    const double radius = exponential(normal(seed, id));
    radii.push_back(radius);
    volume += ball * radius * radius * radius;
    largest = std::max(largest, radius);
  }
  all.side = std::max(side_for(volume), 2 * largest);
  for (std::int64_t id = 0; id < count; ++id) {
    const double radius = radii[static_cast<std::size_t>(id)];
    all.bodies.push_back(
        sphere(radius, place(Vector3d(0, 0, 0), all.side, radius, uniform(seed, id, position_stream))));
  }
  return all;
}

Bodies clusters(std::int64_t count, std::uint64_t seed) {
  constexpr std::int64_t number = 16;
  const double cluster = side_for(static_cast<double>((count + number - 1) / number) * ball);
  Bodies all;
  all.side = 1000 * cluster;
  for (std::int64_t id = 0; id < count; ++id) {
    const Vector3d low =
        place(Vector3d(0, 0, 0), all.side - cluster, 0, uniform(seed, id % number, cluster_stream));
    all.bodies.push_back(sphere(1, place(low, cluster, 0, uniform(seed, id, position_stream))));
  }
  return all;
}

struct Kind {
  std::string name;
  Bodies (*make)(std::int64_t count, std::uint64_t seed);
};
const std::array<Kind, 3>& table() {
  static const std::array<Kind, 3> every{
      {{"mixed", mixed}, {"log_normal", log_normal}, {"clusters", clusters}}};
  return every;
}

}  // namespace

std::span<const std::string> crowded_scene_names() {
  static const std::array<std::string, 3> names{table()[0].name, table()[1].name, table()[2].name};
  return names;
}

std::vector<std::string> compared_scenes() {
  std::vector<std::string> names;
  for (const auto& variant : variant_names) names.emplace_back(variant.name);
  const auto crowded = crowded_scene_names();
  names.insert(names.end(), crowded.begin(), crowded.end());
  return names;
}

Scene crowded_scene(const std::string& name, std::int64_t bodies, std::uint64_t seed, const Scene& like) {
  const Kind& kind = *std::ranges::find(table(), name, &Kind::name);
  Bodies made = kind.make(bodies, seed);
  Scene scene = like;
  scene.name = name;
  scene.generators.clear();
  scene.body_files.clear();
  scene.joints.clear();
  scene.extra_bodies.clear();
  scene.bodies = std::move(made.bodies);
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(made.side, made.side, made.side)};
  return scene;
}

}  // namespace collidoscope
