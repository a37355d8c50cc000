#include "sim_cuda/stability/quantities.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collidoscope {
namespace {

Extremes one(double value) {
  Extremes extremes;
  extremes.take(value);
  return extremes;
}
Extremes one(std::int64_t count) { return one(static_cast<double>(count)); }

/// `value` of each body, or of the only one that the term is about: NaN where there is no such body.
template <class Value>
Extremes of_bodies(const Term& term, std::size_t count, Value value) {
  Extremes extremes;
  if (term.body) {
    extremes.take(*term.body < count ? value(*term.body) : std::numeric_limits<double>::quiet_NaN(),
                  term.body);
    return extremes;
  }
  for (std::size_t body = 0; body < count; ++body)
    extremes.take(value(body), static_cast<std::uint32_t>(body));
  return extremes;
}

/// 0 / 0 is nothing at all.
double over(double value, double scale) { return value == 0 ? 0 : value / scale; }

bool is_finite(const BodyStates& bodies, std::size_t body) {
  return bodies.position[body].allFinite() && bodies.velocity[body].allFinite() &&
         bodies.angular_velocity[body].allFinite() && bodies.orientation[body].coeffs().allFinite();
}

/// Few bodies are read sooner than a state is measured.
std::int64_t non_finite(Observation& seen) {
  constexpr std::size_t few = 1 << 14;
  if (seen.world().initial().size() > few) return seen.stats().non_finite;
  const BodyStates& bodies = seen.bodies();
  std::int64_t count = 0;
  for (std::size_t body = 0; body < bodies.position.size(); ++body) count += is_finite(bodies, body) ? 0 : 1;
  return count;
}

double energy_gain(Observation& seen) {
  const StepStats &now = seen.stats(), &first = seen.first_stats();
  return over(now.energy() - first.energy() - (now.push_work - first.push_work), seen.energy_scale());
}

Extremes displacement(const Term& term, Observation& seen) {
  const BodyStates &now = seen.bodies(), &then = seen.bodies_since(term.since);
  return of_bodies(term, std::min(now.position.size(), then.position.size()),
                   [&](std::size_t body) { return (now.position[body] - then.position[body]).norm(); });
}

double momentum_change(Observation& seen) {
  const World& world = seen.world();
  const StepStats &now = seen.stats(), &first = seen.first_stats();
  const InitialBodies& initial = world.initial();
  double mass = 0;
  for (std::size_t body = 0; body < initial.size(); ++body)
    if (initial.motion.empty() || initial.motion[body] == Motion::dynamic) mass += initial.mass[body];
  Vector3d left = vector_of(now.momentum) - vector_of(first.momentum) - vector_of(now.wall_impulse_vector) +
                  vector_of(first.wall_impulse_vector);
  if (world.effects().gravity) left -= mass * seen.seconds() * world.scene().physics.gravity;
  return over(left.norm(), seen.momentum_scale());
}

double angular_momentum_change(Observation& seen) {
  return over(
      (vector_of(seen.stats().angular_momentum) - vector_of(seen.first_stats().angular_momentum)).norm(),
      seen.turning_scale());
}

Extremes penetration_over_radius(Observation& seen) {
  Extremes extremes;
  extremes.take(0);
  for (const Overlap& overlap : overlaps(seen.world(), seen.bodies()))
    extremes.take(overlap.depth / overlap.radius, overlap.body);
  return extremes;
}

Extremes separation_speed(Observation& seen) {
  Extremes extremes;
  const BodyStates& bodies = seen.bodies();
  for (const auto& [a, b] : seen.overlapping()) {
    if (std::max(a, b) >= bodies.position.size()) continue;  // removed since
    const Vector3d apart = bodies.position[b] - bodies.position[a];
    const double distance = apart.norm();
    const Vector3d normal = distance == 0 ? Vector3d(0, 0, 1) : Vector3d(apart / distance);
    extremes.take(normal.dot(bodies.velocity[b] - bodies.velocity[a]), a);
  }
  return extremes;
}

}  // namespace

void Extremes::take(double value, std::optional<std::uint32_t> body) {
  if (any && !(least <= most)) return;
  if (!any || !(value >= least)) {
    least = value;
    least_body = body;
  }
  if (!any || !(value <= most)) {
    most = value;
    most_body = body;
  }
  any = true;
}

Extremes measured(const Term& term, Observation& seen) {
  const auto each = [&](auto value) {
    const BodyStates& bodies = seen.bodies();
    return of_bodies(term, bodies.position.size(),
                     [&](std::size_t body) { return static_cast<double>(value(bodies, body)); });
  };
  switch (term.quantity) {
    case Quantity::finite:
      return one(non_finite(seen));
    case Quantity::penetration:
      return one(seen.stats().max_penetration);
    case Quantity::penetration_over_radius:
      return penetration_over_radius(seen);
    case Quantity::speed:
      return each([](const BodyStates& b, std::size_t body) { return b.velocity[body].norm(); });
    case Quantity::spin:
      return each([](const BodyStates& b, std::size_t body) { return b.angular_velocity[body].norm(); });
    case Quantity::energy_gain:
      return one(energy_gain(seen));
    case Quantity::energy_loss:
      return one(-energy_gain(seen));
    case Quantity::kinetic_energy:
      return one(seen.stats().kinetic_energy);
    case Quantity::escaped:
      return one(seen.stats().escaped);
    case Quantity::displacement:
      return displacement(term, seen);
    case Quantity::position:
      return each([&](const BodyStates& b, std::size_t body) { return b.position[body][term.axis]; });
    case Quantity::velocity:
      return each([&](const BodyStates& b, std::size_t body) { return b.velocity[body][term.axis]; });
    case Quantity::momentum_change:
      return one(momentum_change(seen));
    case Quantity::angular_momentum_change:
      return one(angular_momentum_change(seen));
    case Quantity::quaternion_norm:
      return each(
          [](const BodyStates& b, std::size_t body) { return std::abs(b.orientation[body].norm() - 1); });
    case Quantity::joint_error:
      return one(seen.stats().max_joint_error);
    case Quantity::joint_angle:
      return one(seen.stats().max_joint_angle);
    case Quantity::pairs:
      return one(seen.stats().pairs);
    case Quantity::touching:
      return one(seen.stats().touching);
    case Quantity::speculative:
      return one(seen.stats().speculative);
    case Quantity::asleep:
      return one(seen.stats().asleep);
    case Quantity::tree_depth:
      return one(std::ssize(seen.world().tree().level_sizes()));
    case Quantity::separation_speed:
      return separation_speed(seen);
    case Quantity::difference:
    case Quantity::other_hash:
    case Quantity::found:
      break;
  }
  return one(std::numeric_limits<double>::quiet_NaN());
}

Extremes difference(const Term& term, const BodyStates& bodies, const BodyStates& other) {
  if (bodies.position.size() != other.position.size()) return one(std::numeric_limits<double>::quiet_NaN());
  return of_bodies(term, bodies.position.size(), [&](std::size_t body) {
    return (bodies.position[body] - term.offset - other.position[body]).norm();
  });
}

std::optional<std::uint32_t> culprit(const Term& term, Observation& seen) {
  const BodyStates& bodies = seen.bodies();
  if (term.quantity == Quantity::finite) {
    for (std::size_t body = 0; body < bodies.position.size(); ++body)
      if (!is_finite(bodies, body)) return static_cast<std::uint32_t>(body);
  } else if (term.quantity == Quantity::penetration) {
    const std::vector<Overlap> all = overlaps(seen.world(), bodies);
    const auto deepest = std::ranges::max_element(all, {}, &Overlap::depth);
    if (deepest != all.end()) return deepest->body;
  } else if (term.quantity == Quantity::escaped && seen.world().initial().box) {
    const Box& box = *seen.world().initial().box;
    for (std::size_t body = 0; body < bodies.position.size(); ++body)
      for (int k = 0; k < 3; ++k)
        if (!(bodies.position[body][k] >= box.min[k] && bodies.position[body][k] <= box.max[k]))
          return static_cast<std::uint32_t>(body);
  }
  return std::nullopt;
}

}  // namespace collidoscope
