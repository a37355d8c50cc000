#include "sim_cuda/stability/observation.h"

#include <algorithm>
#include <cmath>

#include "sim_cuda/solver/box_surface.h"

namespace collidoscope {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

bool is_moved(const InitialBodies& bodies, std::size_t body) {
  return bodies.motion.empty() || bodies.motion[body] == Motion::dynamic;
}

Pairs pairs_excluded_by_joints(const Scene& scene) {
  Pairs excluded;
  for (const Joint& joint : scene.joints)
    if (joint.b && !joint.collide) {
      const auto a = static_cast<std::uint32_t>(joint.a), b = static_cast<std::uint32_t>(*joint.b);
      excluded.emplace_back(std::min(a, b), std::max(a, b));
    }
  std::ranges::sort(excluded);
  return excluded;
}

BoxSurface<double> surface_of(const BoxObstacle& box) {
  BoxSurface<double> surface{};
  surface.center = box.center;
  surface.half = box.size / 2;
  for (int k = 0; k < 3; ++k) surface.side[k] = box.orientation * Vector3d::Unit(k);
  return surface;
}

void pair_overlaps(World& world, const BodyStates& bodies, std::vector<Overlap>& found) {
  const InitialBodies& initial = world.initial();
  const Pairs excluded = pairs_excluded_by_joints(world.scene());
  world.detect();
  for (const auto& [a, b] : world.pairs()) {
    if (!is_moved(initial, a) && !is_moved(initial, b)) continue;
    const double depth =
        initial.radius[a] + initial.radius[b] - (bodies.position[b] - bodies.position[a]).norm();
    if (!(depth > 0) || std::ranges::binary_search(excluded, std::pair(a, b))) continue;
    found.push_back({a, b, depth, std::min(initial.radius[a], initial.radius[b])});
  }
}

void wall_overlaps(const World& world, const BodyStates& bodies, std::vector<Overlap>& found) {
  const InitialBodies& initial = world.initial();
  std::vector<BoxSurface<double>> surfaces;
  for (const BoxObstacle& box : world.scene().boxes) surfaces.push_back(surface_of(box));
  for (std::size_t body = 0; body < initial.size(); ++body) {
    if (!is_moved(initial, body)) continue;
    const Vector3d& x = bodies.position[body];
    const double radius = initial.radius[body];
    double depth = 0;
    for (const Plane& plane : world.scene().obstacles)
      depth = std::max(depth, radius - (plane.normal.dot(x) - plane.offset));
    for (const BoxSurface<double>& surface : surfaces) depth = std::max(depth, -surface.gap(x, radius));
    for (int k = 0; initial.box && k < 3; ++k)
      depth = std::max({depth, radius - (x[k] - initial.box->min[k]), radius - (initial.box->max[k] - x[k])});
    if (depth > 0) found.push_back({static_cast<std::uint32_t>(body), {}, depth, radius});
  }
}

}  // namespace

std::vector<Overlap> overlaps(World& world, const BodyStates& bodies) {
  std::vector<Overlap> found;
  pair_overlaps(world, bodies, found);
  wall_overlaps(world, bodies, found);
  return found;
}

Observation::Observation(World& world, std::span<const Assertion> assertions) : world_(&world) {
  const auto asked = [&](std::initializer_list<Quantity> quantities) {
    return std::ranges::any_of(assertions, [&](const Assertion& assertion) {
      return std::ranges::find(quantities, assertion.quantity) != quantities.end();
    });
  };
  energies_ = asked({Quantity::energy_gain, Quantity::energy_loss});
  momenta_ = asked({Quantity::momentum_change, Quantity::angular_momentum_change});
  for (const Assertion& assertion : assertions)
    if (assertion.quantity == Quantity::displacement) since_[assertion.since];
  if (energies_ || momenta_) first_ = stats();
  if (asked({Quantity::separation_speed}))
    for (const Overlap& overlap : overlaps(world, bodies()))
      if (overlap.other) overlapping_.emplace_back(overlap.body, *overlap.other);
  update_scales();
}

void Observation::update(World& world, double seconds) {
  world_ = &world;
  seconds_ = seconds;
  stats_.reset();
  bodies_.reset();
  update_scales();
}

const StepStats& Observation::stats() {
  if (!stats_) stats_ = world_->measure();
  return *stats_;
}

const BodyStates& Observation::bodies() {
  if (!bodies_) bodies_ = world_->bodies();
  return *bodies_;
}

const BodyStates& Observation::bodies_since(std::int64_t state) {
  const auto known = since_.find(state);
  return known != since_.end() && known->second ? *known->second : bodies();
}

void Observation::update_scales() {
  for (auto& [state, known] : since_)
    if (!known && world_->steps() >= state) known = bodies();
  if (energies_)
    energy_scale_ = std::max(
        energy_scale_, stats().kinetic_energy + std::abs(stats().potential_energy - first_.potential_energy));
  if (!momenta_) return;
  const InitialBodies& initial = world_->initial();
  Vector3d middle(0, 0, 0);
  for (const Vector3d& x : bodies().position) middle += x / static_cast<double>(initial.size());
  double sum = 0, mean = 0, reach = 0;
  for (std::size_t body = 0; body < initial.size(); ++body) {
    if (!is_moved(initial, body)) continue;
    sum += initial.mass[body] * bodies().velocity[body].norm();
    mean += initial.mass[body] * (bodies().position[body] - initial.position[body]).norm();
    reach = std::max(reach, (bodies().position[body] - middle).norm() + initial.radius[body]);
  }
  if (seconds_ > 0) sum = std::max(sum, mean / seconds_);
  const double(&turning)[3] = stats().angular_momentum;
  momentum_scale_ = std::max(momentum_scale_, sum);
  angular_momentum_scale_ =
      std::max({angular_momentum_scale_, sum * reach, Vector3d(turning[0], turning[1], turning[2]).norm()});
}

}  // namespace collidoscope
