#include "sim_cuda/reference/hard_spheres.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "sim_cuda/core/error.h"
#include "sim_cuda/reference/contact_time.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/effect_reasons.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr std::uint32_t collapse_count = 32;  // collisions
constexpr double unresolved = 0x1p12 * epsilon;

/// Rounding error in m/s of a relative velocity that should be 0 after a collision.
double noise_of(const Vector3d& velocity) { return 8 * epsilon * velocity.lpNorm<1>(); }

/// Throws InputError with one line per unsupported feature of the scene.
void refuse_unsupported(const Scene& scene, const InitialBodies& bodies, const Effects& effects) {
  std::vector<std::string> faults;
  const auto fault = [&](const std::string& what) {
    faults.push_back(fmt::format(
        "{}: the event-driven reference supports only spheres, planes, gravity and restitution, not {}",
        scene.file.empty() ? scene.name : scene.file, what));
  };
  for (const EffectName& effect : effect_names) {
    const bool known = effect.flag == &Effects::gravity || effect.flag == &Effects::continuous_collision;
    if (known || !(effects.*effect.flag)) continue;
    const EffectReason reason = effect_reason(scene, bodies, effect.flag);
    fault(
        fmt::format("{} ({})", effect.name, reason.required ? reason.why : "in the scene's list of effects"));
  }
  if (!scene.boxes.empty()) fault("box obstacles");
  if (!bodies.meshes.empty()) fault(fmt::format("meshes ({})", bodies.meshes.front().name));
  for (std::size_t i = 0; i < bodies.motion.size(); ++i)
    if (bodies.motion[i] != Motion::dynamic) {
      fault(fmt::format("static or kinematic bodies (body {})", i));
      break;
    }
  if (needs_presimulation(scene)) fault("piles at rest (variant settled): infinitely many collisions");
  if (!faults.empty()) throw InputError(std::move(faults));
}

std::vector<WallPlane<double>> planes_of(const Scene& scene, const std::optional<Box>& box) {
  std::vector<WallPlane<double>> planes;
  for (const Plane& p : scene.obstacles)
    planes.push_back(
        {p.normal, p.offset, scene.materials[static_cast<std::size_t>(p.material)].restitution, 0});
  for (int axis = 0; box && axis < 3; ++axis) {
    const Vector3d inward = Vector3d::Unit(axis);
    planes.push_back({inward, box->min[axis], scene.materials[0].restitution, 0});
    planes.push_back({-inward, -box->max[axis], scene.materials[0].restitution, 0});
  }
  return planes;
}

}  // namespace

double collision_time(const Flight& a, const Flight& b, const Vector3d& gravity) {
  const double start = a.start > b.start ? a.start : b.start;
  const Vector3d va = a.velocity(start, gravity), vb = b.velocity(start, gravity);
  return start + time_to_contact(b.position(start, gravity) - a.position(start, gravity), vb - va,
                                 a.radius + b.radius, noise_of(va) + noise_of(vb));
}

HardSpheres::HardSpheres(const Scene& scene)
    : initial_(initial_bodies(scene)),
      gravity_(0, 0, 0),
      planes_(planes_of(scene, initial_.box)),
      threshold_(scene.physics.restitution_threshold.value_or(0)) {
  const Effects effects = scene.physics.effects.value_or(required_effects(scene, initial_));
  refuse_unsupported(scene, initial_, effects);
  if (effects.gravity) gravity_ = scene.physics.gravity;
  for (const Material& material : scene.materials) restitutions_.push_back(material.restitution);

  const std::size_t bodies = initial_.size();
  histories_.resize(bodies);
  if (!planes_.empty()) static_impulses_.resize(bodies);
  Vector3d low(0, 0, 0), high(0, 0, 0);
  double largest = 0;
  for (std::size_t i = 0; i < bodies; ++i) {
    const Vector3d& x = initial_.position[i];
    flights_.push_back(
        {x, initial_.velocity.empty() ? Vector3d(0, 0, 0) : initial_.velocity[i], 0, initial_.radius[i]});
    largest = std::max(largest, initial_.radius[i]);
    low = i == 0 ? x : Vector3d(low.cwiseMin(x));
    high = i == 0 ? x : Vector3d(high.cwiseMax(x));
  }
  if (bodies == 0) return;
  grid_.emplace(initial_.box ? initial_.box->min : low, initial_.box ? initial_.box->max : high, 2 * largest,
                bodies);
  for (const Flight& flight : flights_) grid_->add(flight.x);
  refuse_overlaps(scene.file.empty() ? scene.name : scene.file);

  for (std::uint32_t i = 0; i < count(); ++i) {
    predict_plane(i);
    predict_crossing(i);
    grid_->for_neighbours(i, [&](std::uint32_t other) {
      if (i < other) predict_pair(i, other);
    });
  }
}

void HardSpheres::refuse_overlaps(const std::string& name) const {
  std::vector<std::string> faults;
  const auto fault = [&](const std::string& what, double depth) {
    faults.push_back(
        fmt::format("{}: {} by {:.3g} m at the start; hard spheres must not overlap (spawn \"apart\")", name,
                    what, depth));
  };
  for (std::uint32_t i = 0; i < count() && faults.size() < 100; ++i) {
    const Flight& a = flights_[i];
    const double rounding = 4 * epsilon * a.x.lpNorm<1>();
    for (std::uint32_t p = 0; p < planes_.size(); ++p) {
      const double depth = -gap(a.x, i, planes_[p]);
      if (depth > 1e-9 * a.radius + rounding) fault(fmt::format("body {} is behind plane {}", i, p), depth);
    }
    grid_->for_neighbours(i, [&](std::uint32_t j) {
      const double reach = a.radius + flights_[j].radius, depth = reach - (flights_[j].x - a.x).norm();
      if (i < j && depth > 1e-9 * reach + rounding)
        fault(fmt::format("bodies {} and {} overlap", i, j), depth);
    });
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

// ---- Prediction ----

bool HardSpheres::is_stale(const Event& event) const {
  return histories_[event.body].collisions != event.collision_count ||
         (event.other < count() && histories_[event.other].collisions != event.other_collision_count);
}

void HardSpheres::predict_pair(std::uint32_t a, std::uint32_t b) {
  if (b < a) std::swap(a, b);
  const double time = collision_time(flights_[a], flights_[b], gravity_);
  if (time < never) queue_.add({time, a, b, histories_[a].collisions, histories_[b].collisions});
}

HardSpheres::Start HardSpheres::start_above(std::uint32_t p, std::uint32_t body) const {
  const CollisionHistory& history = histories_[body];
  if (history.touching == p) return {0, history.rebound};
  const Flight& flight = flights_[body];
  return {gap(flight.x, body, planes_[p]), planes_[p].normal.dot(flight.v)};
}

void HardSpheres::predict_plane(std::uint32_t body) {
  const Flight& flight = flights_[body];
  const double noise = noise_of(flight.v);
  Event next{never, body, 0, histories_[body].collisions, 0};
  for (std::uint32_t p = 0; p < planes_.size(); ++p) {
    const Start start = start_above(p, body);
    const double time =
        flight.start + time_to_plane(start.gap, start.speed, planes_[p].normal.dot(gravity_), noise);
    if (time < next.time) next.time = time, next.other = count() + p;
  }
  if (next.time < never) queue_.add(next);
}

void HardSpheres::predict_crossing(std::uint32_t body) {
  const Flight& flight = flights_[body];
  const NeighbourGrid::Crossing next = grid_->next_crossing(body, flight.position(time_, gravity_),
                                                            flight.velocity(time_, gravity_), gravity_);
  if (next.after < never)
    queue_.add({time_ + next.after, body, first_edge() + static_cast<std::uint32_t>(next.edge),
                histories_[body].collisions, 0});
}

void HardSpheres::predict(std::uint32_t body) {
  predict_plane(body);
  predict_crossing(body);
  grid_->for_neighbours(body, [&](std::uint32_t other) { predict_pair(body, other); });
}

// ---- Event processing ----

bool HardSpheres::advance_to(double time) {
  if (!(time >= time_)) throw std::logic_error("advance_to: the time must not decrease");
  while (next_collision(time)) {
  }
  return !zeno_;
}

std::optional<CollisionEvent> HardSpheres::next_collision(double until) {
  while (!zeno_ && !queue_.empty() && queue_.next().time <= until) {
    const Event event = queue_.next();
    queue_.drop_next();
    if (is_stale(event)) {
      ++counts_.stale;
      continue;
    }
    time_ = std::max(time_, event.time);  // rounding may predict an event slightly in the past
    if (event.other >= first_edge()) {
      const int edge = static_cast<int>(event.other - first_edge());
      ++counts_.crossings;
      grid_->cross(event.body, edge);
      predict_crossing(event.body);
      grid_->for_new_neighbours(event.body, edge,
                                [&](std::uint32_t other) { predict_pair(event.body, other); });
      continue;
    }
    const CollisionEvent done =
        event.other < count() ? collide(event.body, event.other) : bounce(event.body, event.other - count());
    if (queue_.size() > queue_limit_) {
      queue_.drop_if([&](const Event& old) { return is_stale(old); });
      queue_limit_ = std::max<std::size_t>(2 * queue_.size(), 1024);
    }
    return done;
  }
  if (!zeno_ && until < never) time_ = std::max(time_, until);
  return std::nullopt;
}

/// Restarts a body's flight at the current time.
void HardSpheres::restart(std::uint32_t body) {
  Flight& flight = flights_[body];
  CollisionHistory& history = histories_[body];
  if (flight.start < time_) {
    const Vector3d x = flight.position(time_, gravity_);
    flight.v = flight.velocity(time_, gravity_);
    flight.x = x;
    flight.start = time_;
    history.touching = no_plane;
  }
  ++history.collisions;
}

/// Call after an inelastic collision. `since` is the time in s since the body's previous collision. Returns
/// true at inelastic collapse.
bool HardSpheres::detect_inelastic_collapse(std::uint32_t body, double since, double approach) {
  const double size = flights_[body].x.lpNorm<1>() + flights_[body].radius;
  const bool distinguishable = since > unresolved * time_ && since * approach > unresolved * size;
  CollisionHistory& history = histories_[body];
  history.coincident_collisions = distinguishable ? 0 : history.coincident_collisions + 1;
  return history.coincident_collisions >= collapse_count;
}

CollisionEvent HardSpheres::collide(std::uint32_t a, std::uint32_t b) {
  ++counts_.pairs;
  Flight &left = flights_[a], &right = flights_[b];
  const double since_a = time_ - left.start, since_b = time_ - right.start;
  restart(a);
  restart(b);
  const Vector3d d = left.x - right.x;
  const double distance = d.norm();
  CollisionEvent done{time_, a, b, no_plane, distance > 0 ? Vector3d(d / distance) : Vector3d(0, 0, -1), 0};
  const double approach = done.normal.dot(right.v - left.v);
  if (approach > 0) {
    const double e = restitution().of_pair({a, b}, approach);
    const double inverse_mass_a = 1 / initial_.mass[a], inverse_mass_b = 1 / initial_.mass[b];
    done.impulse = (1 + e) * approach / (inverse_mass_a + inverse_mass_b);
    left.v += done.impulse * inverse_mass_a * done.normal;
    right.v -= done.impulse * inverse_mass_b * done.normal;
    for (const std::uint32_t body : {a, b})
      if (CollisionHistory& history = histories_[body]; history.touching != no_plane)
        history.rebound = planes_[history.touching].normal.dot(flights_[body].v);
    dissipated_ += done.impulse * (1 - e) * approach / 2;
    if (e < 1) {
      const bool collapse_a = detect_inelastic_collapse(a, since_a, approach),
                 collapse_b = detect_inelastic_collapse(b, since_b, approach);
      if (collapse_a || collapse_b) zeno_ = done;
    }
  }
  predict(a);
  predict(b);
  return done;
}

/// The approach speed is computed from the parabola at the plane instead of the rounded event time. Clock
/// rounding would otherwise add energy to small bounces and delay the Zeno point.
CollisionEvent HardSpheres::bounce(std::uint32_t body, std::uint32_t p) {
  ++counts_.planes;
  Flight& flight = flights_[body];
  CollisionHistory& history = histories_[body];
  const WallPlane<double>& plane = planes_[p];
  const Start start = start_above(p, body);
  const double pull = plane.normal.dot(gravity_), since = time_ - flight.start;
  const double square = start.speed * start.speed - 2 * pull * start.gap;
  const double approach = square > 0 ? std::sqrt(square) : 0;
  const double e = restitution().between(restitution().of_body(body), plane.restitution, approach);
  const bool collapsed = e < 1 && history.touching != p && detect_inelastic_collapse(body, since, approach);

  restart(body);
  flight.x -= gap(flight.x, body, plane) * plane.normal;
  const double change = e * approach - plane.normal.dot(flight.v);
  flight.v += change * plane.normal;
  history.touching = p;
  history.rebound = e * approach;
  const double mass = initial_.mass[body];
  const CollisionEvent done{time_, body, no_body, p, plane.normal, mass * change};
  StaticImpulse& static_impulse = static_impulses_[body];
  static_impulse.impulse += done.impulse;
  for (int k = 0; k < 3; ++k) static_impulse.vector[k] += done.impulse * plane.normal[k];
  dissipated_ += mass * (1 - e * e) * approach * approach / 2;

  const bool rests = time_ + time_to_plane(0, history.rebound, pull, 0) == time_;
  if (collapsed || rests) zeno_ = done;
  predict(body);
  return done;
}

std::string HardSpheres::zeno_line() const {
  if (!zeno_) return "";
  if (zeno_->other != no_body)
    return fmt::format("Zeno point at {:.9g} s: infinitely many collisions of bodies {} and {}", zeno_->time,
                       zeno_->body, zeno_->other);
  const std::size_t obstacles = planes_.size() - (initial_.box ? 6 : 0);
  const std::size_t face = zeno_->plane - obstacles;
  return fmt::format("Zeno point at {:.9g} s: body {} comes to rest on {}", zeno_->time, zeno_->body,
                     zeno_->plane < obstacles
                         ? fmt::format("plane {} of the obstacles", zeno_->plane)
                         : fmt::format("the wall {} = {:g}", "xyz"[face / 2],
                                       face % 2 ? initial_.box->max[static_cast<int>(face / 2)]
                                                : initial_.box->min[static_cast<int>(face / 2)]));
}

// ---- State output ----

BodyStates HardSpheres::bodies() const {
  BodyStates states;
  for (const Flight& flight : flights_) {
    states.position.push_back(flight.position(time_, gravity_));
    states.velocity.push_back(flight.velocity(time_, gravity_));
  }
  states.angular_velocity.resize(count(), Vector3d(0, 0, 0));
  states.orientation.resize(count(), Quaterniond(1, 0, 0, 0));
  return states;
}

StepStats HardSpheres::measure() const {
  StepStats stats;
  stats.bodies = count();
  const BodyStates now = bodies();
  const Vector3d ground(0, 0, initial_.box ? initial_.box->min.z() : 0);
  Vector3d momentum(0, 0, 0), angular_momentum(0, 0, 0);
  for (std::uint32_t i = 0; i < count(); ++i) {
    const Vector3d &x = now.position[i], &v = now.velocity[i];
    const double mass = initial_.mass[i];
    stats.kinetic_energy += mass * v.squaredNorm() / 2;
    stats.potential_energy -= mass * gravity_.dot(x - ground);
    momentum += mass * v;
    angular_momentum += x.cross(mass * v);
    stats.max_speed = std::max(stats.max_speed, v.norm());
    for (const WallPlane<double>& plane : planes_)
      stats.max_penetration = std::max(stats.max_penetration, -gap(x, i, plane));
    grid_->for_neighbours(i, [&](std::uint32_t j) {
      const double reach = flights_[i].radius + flights_[j].radius;
      stats.max_penetration = std::max(stats.max_penetration, reach - (now.position[j] - x).norm());
    });
    if (initial_.box)
      stats.escaped +=
          (x.array() < initial_.box->min.array()).any() || (x.array() > initial_.box->max.array()).any();
  }
  for (const StaticImpulse& static_impulse : static_impulses_) {
    stats.wall_impulse += static_impulse.impulse;
    for (int k = 0; k < 3; ++k) stats.wall_impulse_vector[k] += static_impulse.vector[k];
  }
  for (int k = 0; k < 3; ++k) {
    stats.momentum[k] = momentum[k];
    stats.angular_momentum[k] = angular_momentum[k];
  }
  return stats;
}

}  // namespace collidoscope
