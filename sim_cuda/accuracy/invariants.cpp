#include "sim_cuda/accuracy/invariants.h"

#include <algorithm>
#include <cmath>

namespace collidoscope {
namespace {

/// Sets `worst` to the maximum. An unknown value counts as the minimum.
void take(double& worst, double value) {
  if (!(worst >= value)) worst = value;
}

bool all_dynamic(const InitialBodies& bodies) {
  return std::ranges::all_of(bodies.motion, [](Motion motion) { return motion == Motion::dynamic; });
}

bool held_by_the_world(const Scene& scene) {
  return std::ranges::any_of(scene.joints, [](const Joint& joint) { return !joint.b.has_value(); });
}

}  // namespace

InvariantScales::InvariantScales(const std::vector<ReferenceSample>& samples, const InitialBodies& bodies) {
  double kinetic = 0, moving = 0, turning = 0;
  for (const ReferenceSample& sample : samples) {
    double sum = 0, reach = 0;
    Vector3d middle(0, 0, 0);
    for (const Vector3d& x : sample.bodies.position) middle += x / static_cast<double>(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (!bodies.motion.empty() && bodies.motion[i] != Motion::dynamic) continue;
      sum += bodies.mass[i] * sample.bodies.velocity[i].norm();
      reach = std::max(reach, (sample.bodies.position[i] - middle).norm() + bodies.radius[i]);
    }
    kinetic = std::max(kinetic, sample.stats.kinetic_energy);
    moving = std::max(moving, sum);
    turning = std::max({turning, sum * reach, vector_of(sample.stats.angular_momentum).norm()});
  }
  if (kinetic > 0) energy = kinetic;
  if (moving > 0) momentum = moving;
  if (turning > 0) angular_momentum = turning;
}

InvariantCollector::InvariantCollector(const AccuracyProblem& problem, const InvariantScales& scales)
    : problem_(problem), scales_(scales) {}

void InvariantCollector::add_sample(World& world, double time, const StepStats* expected) {
  const StepStats now = world.measure();
  if (!started_) first_ = now;
  started_ = true;
  if (expected != nullptr) {
    take(result_.energy_error, std::abs(now.energy() - expected->energy()) / scales_.energy);
    take(result_.angular_momentum_error,
         (vector_of(now.angular_momentum) - vector_of(expected->angular_momentum)).norm() /
             scales_.angular_momentum);
  }
  result_.energy_drift = (now.energy() - first_.energy()) / scales_.energy;
  balance(now, time);
  take(result_.penetration_max, now.max_penetration);
  const RunState state = world.state();
  overlap(world, state.bodies);
  if (now.joints > 0) {
    take(result_.joint_error, now.max_joint_error);
    take(result_.joint_angle, now.max_joint_angle);
  }
  if (problem_.effects.friction) cones(state);
}

void InvariantCollector::balance(const StepStats& now, double time) {
  const Scene& scene = problem_.scene;
  const Effects& effects = problem_.effects;
  if (effects.drag || effects.sleeping || held_by_the_world(scene) || !all_dynamic(problem_.initial)) return;
  const Vector3d gravity = effects.gravity ? scene.physics.gravity : Vector3d(0, 0, 0);
  double mass = 0;
  Vector3d moment(0, 0, 0);  // kg m
  for (std::size_t i = 0; i < problem_.initial.size(); ++i) {
    mass += problem_.initial.mass[i];
    moment += problem_.initial.mass[i] * problem_.start.bodies.position[i];
  }
  const Vector3d momentum = vector_of(first_.momentum);
  if (!effects.attractor)
    take(result_.momentum_balance, (vector_of(now.momentum) - momentum - vector_of(now.wall_impulse_vector) +
                                    vector_of(first_.wall_impulse_vector) - mass * time * gravity)
                                           .norm() /
                                       scales_.momentum);
  const bool walls = problem_.initial.box || !scene.obstacles.empty() || !scene.boxes.empty();
  const std::vector<Attractor>& attractors = scene.physics.attractors;
  if (walls || (effects.attractor && (effects.gravity || attractors.size() != 1))) return;
  // Moments about the only attractor, or about the origin. Gravity's torque is known, because the centre of
  // mass falls freely.
  const Vector3d about = effects.attractor ? attractors[0].position : Vector3d(0, 0, 0);
  const auto turning = [&](const StepStats& stats) -> Vector3d {
    return vector_of(stats.angular_momentum) - about.cross(vector_of(stats.momentum));
  };
  const Vector3d torque = (time * moment + time * time / 2 * momentum).cross(gravity);
  take(result_.angular_momentum_balance,
       (turning(now) - turning(first_) - torque).norm() / scales_.angular_momentum);
}

void InvariantCollector::overlap(World& world, const BodyStates& bodies) {
  const std::vector<double>& radius = problem_.initial.radius;
  for (const auto& [a, b] : world.pairs()) {
    const double gap = (bodies.position[b] - bodies.position[a]).norm() - radius[a] - radius[b];
    if (!(gap < 0)) continue;
    const double share = gap / std::min(radius[a], radius[b]);
    squares_ += gap * gap;
    shares_ += share * share;
    ++overlaps_;
  }
  const auto count = static_cast<double>(std::max<std::int64_t>(overlaps_, 1));
  result_.penetration_rms = std::sqrt(squares_ / count);
  result_.penetration_over_radius = std::sqrt(shares_ / count);
}

void InvariantCollector::cones(const RunState& state) {
  const Scene& scene = problem_.scene;
  const std::vector<std::uint16_t>& material = problem_.initial.material;
  const auto friction = [&](std::uint32_t body) {
    return scene.materials[material.empty() ? 0 : material[body]].friction;
  };
  double most = 0, beyond = 0;  // N s
  const auto compare = [&](double product, double impulse, const std::array<double, 3>& tangential) {
    const double allowed = std::sqrt(product) * impulse;
    most = std::max(most, allowed);
    beyond = std::max(beyond, Vector3d(tangential[0], tangential[1], tangential[2]).norm() - allowed);
  };
  const WarmStart& warm_start = state.warm_start;
  for (std::size_t k = 0; k < warm_start.friction.size(); ++k) {
    const ContactImpulse& contact = warm_start.contacts[k];
    compare(friction(contact.a) * friction(contact.b), contact.impulse, warm_start.friction[k]);
  }
  const std::size_t planes = scene.obstacles.size() + (problem_.initial.box ? 6 : 0);
  const std::size_t bodies = problem_.initial.size();
  for (std::size_t p = 0;
       p < std::min(planes, warm_start.wall_friction.size() / std::max<std::size_t>(bodies, 1)); ++p) {
    const int of_wall = p < scene.obstacles.size() ? scene.obstacles[p].material : 0;
    for (std::uint32_t body = 0; body < bodies; ++body)
      compare(friction(body) * scene.materials[static_cast<std::size_t>(of_wall)].friction,
              warm_start.walls[p][body], warm_start.wall_friction[p * bodies + body]);
  }
  take(result_.cone_violation, most > 0 ? beyond / most : 0);
}

}  // namespace collidoscope
