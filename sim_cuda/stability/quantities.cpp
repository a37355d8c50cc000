#include "sim_cuda/stability/quantities.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collidoscope {
namespace {

Extremes single(double value) {
  Extremes extremes;
  extremes.add(value);
  return extremes;
}
Extremes single(std::int64_t count) { return single(static_cast<double>(count)); }

/// Extremes of `value` over all bodies, or over the assertion's body. NaN if that body does not exist.
template <class Value>
Extremes of_bodies(const Assertion& assertion, std::size_t count, Value value) {
  Extremes extremes;
  if (assertion.body) {
    extremes.add(*assertion.body < count ? value(*assertion.body) : std::numeric_limits<double>::quiet_NaN(),
                 assertion.body);
    return extremes;
  }
  for (std::size_t body = 0; body < count; ++body)
    extremes.add(value(body), static_cast<std::uint32_t>(body));
  return extremes;
}

/// Defines 0 / 0 as 0.
double over(double value, double scale) { return value == 0 ? 0 : value / scale; }

bool is_finite(const BodyStates& bodies, std::size_t body) {
  return bodies.position[body].allFinite() && bodies.velocity[body].allFinite() &&
         bodies.angular_velocity[body].allFinite() && bodies.orientation[body].coeffs().allFinite();
}

/// For few bodies, reading the states is faster than measuring statistics.
std::int64_t non_finite(Observation& observation) {
  constexpr std::size_t few = 1 << 14;
  if (observation.world().initial().size() > few) return observation.stats().non_finite;
  const BodyStates& bodies = observation.bodies();
  std::int64_t count = 0;
  for (std::size_t body = 0; body < bodies.position.size(); ++body) count += is_finite(bodies, body) ? 0 : 1;
  return count;
}

double energy_gain(Observation& observation) {
  const StepStats &now = observation.stats(), &first = observation.first_stats();
  return over(now.energy() - first.energy() - (now.push_work - first.push_work), observation.energy_scale());
}

Extremes displacement(const Assertion& assertion, Observation& observation) {
  const BodyStates &now = observation.bodies(), &then = observation.bodies_since(assertion.since);
  return of_bodies(assertion, std::min(now.position.size(), then.position.size()),
                   [&](std::size_t body) { return (now.position[body] - then.position[body]).norm(); });
}

double momentum_change(Observation& observation) {
  const World& world = observation.world();
  const StepStats &now = observation.stats(), &first = observation.first_stats();
  const InitialBodies& initial = world.initial();
  double mass = 0;
  for (std::size_t body = 0; body < initial.size(); ++body)
    if (initial.motion.empty() || initial.motion[body] == Motion::dynamic) mass += initial.mass[body];
  Vector3d left = vector_of(now.momentum) - vector_of(first.momentum) - vector_of(now.wall_impulse_vector) +
                  vector_of(first.wall_impulse_vector);
  if (world.effects().gravity) left -= mass * observation.seconds() * world.scene().physics.gravity;
  return over(left.norm(), observation.momentum_scale());
}

double angular_momentum_change(Observation& observation) {
  return over((vector_of(observation.stats().angular_momentum) -
               vector_of(observation.first_stats().angular_momentum))
                  .norm(),
              observation.angular_momentum_scale());
}

Extremes penetration_over_radius(Observation& observation) {
  Extremes extremes;
  extremes.add(0);
  for (const Overlap& overlap : overlaps(observation.world(), observation.bodies()))
    extremes.add(overlap.depth / overlap.radius, overlap.body);
  return extremes;
}

Extremes separation_speed(Observation& observation) {
  Extremes extremes;
  const BodyStates& bodies = observation.bodies();
  for (const auto& [a, b] : observation.overlapping()) {
    if (std::max(a, b) >= bodies.position.size()) continue;  // removed during the run
    const Vector3d apart = bodies.position[b] - bodies.position[a];
    const double distance = apart.norm();
    const Vector3d normal = distance == 0 ? Vector3d(0, 0, 1) : Vector3d(apart / distance);
    extremes.add(normal.dot(bodies.velocity[b] - bodies.velocity[a]), a);
  }
  return extremes;
}

}  // namespace

void Extremes::add(double value, std::optional<std::uint32_t> body) {
  if (any && !(min <= max)) return;
  if (!any || !(value >= min)) {
    min = value;
    min_body = body;
  }
  if (!any || !(value <= max)) {
    max = value;
    max_body = body;
  }
  any = true;
}

Extremes measured(const Assertion& assertion, Observation& observation) {
  const auto each = [&](auto value) {
    const BodyStates& bodies = observation.bodies();
    return of_bodies(assertion, bodies.position.size(),
                     [&](std::size_t body) { return static_cast<double>(value(bodies, body)); });
  };
  switch (assertion.quantity) {
    case Quantity::finite:
      return single(non_finite(observation));
    case Quantity::penetration:
      return single(observation.stats().max_penetration);
    case Quantity::penetration_over_radius:
      return penetration_over_radius(observation);
    case Quantity::speed:
      return each([](const BodyStates& b, std::size_t body) { return b.velocity[body].norm(); });
    case Quantity::angular_speed:
      return each([](const BodyStates& b, std::size_t body) { return b.angular_velocity[body].norm(); });
    case Quantity::energy_gain:
      return single(energy_gain(observation));
    case Quantity::energy_loss:
      return single(-energy_gain(observation));
    case Quantity::kinetic_energy:
      return single(observation.stats().kinetic_energy);
    case Quantity::escaped:
      return single(observation.stats().escaped);
    case Quantity::displacement:
      return displacement(assertion, observation);
    case Quantity::position:
      return each([&](const BodyStates& b, std::size_t body) { return b.position[body][assertion.axis]; });
    case Quantity::velocity:
      return each([&](const BodyStates& b, std::size_t body) { return b.velocity[body][assertion.axis]; });
    case Quantity::momentum_change:
      return single(momentum_change(observation));
    case Quantity::angular_momentum_change:
      return single(angular_momentum_change(observation));
    case Quantity::quaternion_norm:
      return each(
          [](const BodyStates& b, std::size_t body) { return std::abs(b.orientation[body].norm() - 1); });
    case Quantity::joint_error:
      return single(observation.stats().max_joint_error);
    case Quantity::joint_angle:
      return single(observation.stats().max_joint_angle);
    case Quantity::pairs:
      return single(observation.stats().pairs);
    case Quantity::touching:
      return single(observation.stats().touching);
    case Quantity::speculative:
      return single(observation.stats().speculative);
    case Quantity::asleep:
      return single(observation.stats().asleep);
    case Quantity::tree_depth:
      return single(std::ssize(observation.world().tree().level_sizes()));
    case Quantity::separation_speed:
      return separation_speed(observation);
    case Quantity::difference:
    case Quantity::other_hash:
    case Quantity::expected_finding:
      break;
  }
  return single(std::numeric_limits<double>::quiet_NaN());
}

Extremes difference(const Assertion& assertion, const BodyStates& bodies, const BodyStates& other) {
  if (bodies.position.size() != other.position.size())
    return single(std::numeric_limits<double>::quiet_NaN());
  return of_bodies(assertion, bodies.position.size(), [&](std::size_t body) {
    return (bodies.position[body] - assertion.offset - other.position[body]).norm();
  });
}

std::optional<std::uint32_t> offending_body(const Assertion& assertion, Observation& observation) {
  const BodyStates& bodies = observation.bodies();
  if (assertion.quantity == Quantity::finite) {
    for (std::size_t body = 0; body < bodies.position.size(); ++body)
      if (!is_finite(bodies, body)) return static_cast<std::uint32_t>(body);
  } else if (assertion.quantity == Quantity::penetration) {
    const std::vector<Overlap> all = overlaps(observation.world(), bodies);
    const auto deepest = std::ranges::max_element(all, {}, &Overlap::depth);
    if (deepest != all.end()) return deepest->body;
  } else if (assertion.quantity == Quantity::escaped && observation.world().initial().box) {
    const Box& box = *observation.world().initial().box;
    for (std::size_t body = 0; body < bodies.position.size(); ++body)
      for (int k = 0; k < 3; ++k)
        if (!(bodies.position[body][k] >= box.min[k] && bodies.position[body][k] <= box.max[k]))
          return static_cast<std::uint32_t>(body);
  }
  return std::nullopt;
}

}  // namespace collidoscope
