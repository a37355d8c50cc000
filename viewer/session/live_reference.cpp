#include "viewer/session/live_reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/changes/changes.h"
#include "sim_cuda/core/deadline.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/stage_clock.h"
#include "sim_cuda/core/statistics.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

/// The scene with its bodies listed, as they are in the world.
Scene scene_of_now(World& world) {
  Scene scene = world.scene();
  const InitialBodies& initial = world.initial();
  const BodyStates now = world.bodies();
  scene.box = initial.box;
  scene.generators.clear();
  scene.added.clear();
  scene.bodies.assign(initial.size(), {});
  for (std::size_t i = 0; i < initial.size(); ++i) {
    Body& body = scene.bodies[i];
    if (!initial.mesh.empty() && initial.mesh[i] > 0) body.shape = Shape::mesh;
    if (!initial.motion.empty()) body.motion = initial.motion[i];
    if (!initial.material.empty()) body.material = initial.material[i];
    body.radius = initial.radius[i];
    body.mass = initial.mass[i];
    body.position = now.position[i];
    body.velocity = now.velocity[i];
    body.angular_velocity = now.angular_velocity[i];
  }
  return scene;
}

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

std::string problem_of(const World& world) {
  Effects effects = world.effects();
  effects.continuous_collision = false;
  Scene scene = with_setting(world.scene(), {}, effects);
  scene.physics.restitution_threshold.reset();
  return write_scene(scene);
}

void LiveReference::forget() {
  if (facts_.name.empty()) return;
  const int version = version_ + 1;
  *this = {};
  version_ = version;
}

std::string LiveReference::lack_of(std::int64_t bodies) {
  return bodies > most_bodies ? fmt::format("no reference of more than {} bodies", most_bodies) : "";
}

void LiveReference::follow(World& world, int generation) {
  if (generation == generation_ && world.steps() == steps_) return;
  const bool another = generation != generation_;
  const std::string problem = another ? problem_of(world) : problem_;
  generation_ = generation;
  ++version_;
  if (problem == problem_ && world.steps() == steps_ && !facts_.name.empty()) return;  // it was only turned
  problem_ = problem;
  begin(world);
}

void LiveReference::begin(World& world) {
  steps_ = world.steps();
  time_ = 0;
  exact_.reset();
  runs_.clear();
  looked_ = false;
  facts_ = {};
  facts_.since = steps_;
  facts_.name = "none";
  facts_.lack = lack_of(static_cast<std::int64_t>(world.initial().size()));
  if (!facts_.lack.empty()) return;
  try {
    exact_ = std::make_unique<HardSpheres>(steps_ == 0 ? world.scene() : scene_of_now(world));
    facts_.name = "hard spheres, event by event";
    return;
  } catch (const InputError&) {  // not such a scene
  }
  Scene scene = world.scene();
  scene.physics.precision = Precision::f64;
  leave_out_guards(scene.physics);
  const RunState state = world.state();
  try {
    for (const int parts : {8, 4}) {
      scene.physics.time_step = world.scene().physics.time_step / parts;
      runs_.push_back({std::make_unique<World>(scene, world.options(), &state), parts});
    }
    facts_.name = "the same in double, in steps of 1/8";
  } catch (const std::exception& error) {  // most likely no memory for two more worlds
    runs_.clear();
    facts_.lack = error.what();
  }
}

/// Another step of the run is another part of it, as near to the one so far as there is.
void LiveReference::fit(Run& run, double dt) {
  const double now = run.world->scene().physics.time_step;
  run.parts = std::max(1, static_cast<int>(std::lround(dt / now)));
  if (std::abs(run.parts * now - dt) <= 1e-12 * dt) return;
  Change change;
  change.step = run.world->steps();
  change.settings.set<&Physics::time_step>(dt / run.parts);
  run.world = changed_world(*run.world, change, run.world->options());
}

bool LiveReference::go_ahead(double dt, double milliseconds) {
  if (!facts_.known()) return true;
  const Deadline slice(milliseconds);
  if (!looked_) compare();
  if (exact_) {
    constexpr int parts = 16;
    const double target = time_ + dt;
    while (exact_->time() < target && !exact_->zeno_point()) {
      exact_->advance_to(std::min(target, exact_->time() + dt / parts));
      if (slice.passed()) break;
    }
    return exact_->time() >= target || exact_->zeno_point().has_value();
  }
  try {
    for (Run& run : runs_) {
      if (run.done == 0) fit(run, dt);
      while (run.done < run.parts) {
        run.world->step();
        ++run.done;
        if (slice.passed()) return &run == &runs_.back() && run.done == run.parts;
      }
    }
  } catch (const std::exception& error) {  // no memory for what they grew to
    runs_.clear();
    facts_.lack = error.what();
  }
  return true;
}

void LiveReference::stepped(double dt) {
  if (facts_.name.empty()) return;
  ++steps_;
  time_ += dt;
  for (Run& run : runs_) run.done = 0;
  looked_ = false;
  ++version_;
}

/// Takes what the reference has of this state, before it goes on.
void LiveReference::compare() {
  looked_ = true;
  if (exact_) truth_ = exact_->bodies();
  if (!runs_.empty()) {
    truth_ = runs_[0].world->bodies();
    neighbour_ = runs_[1].world->bodies();
  }
}

std::vector<GhostInstance> LiveReference::ghosts(World& world, int generation) {
  follow(world, generation);
  std::vector<GhostInstance> ghosts;
  std::vector<float> errors;
  if (facts_.known() && !looked_) compare();
  if (facts_.known() && exact_) {
    const double collisions = 2.0 * static_cast<double>(exact_->counts().pairs) /
                              static_cast<double>(std::max<std::size_t>(world.initial().size(), 1));
    if (exact_->zeno_point() && exact_->time() < time_)
      facts_.lack = exact_->zeno_line();
    else if (collisions > 20)
      facts_.lack = "after 20 collisions of each sphere rounding decides";
  }
  if (!facts_.known()) {
    world.publisher().set_errors({});
    return ghosts;
  }
  const BodyStates now = world.bodies();
  const std::vector<double>& radius = world.initial().radius;
  const std::size_t count = radius.size();
  double sum = 0, doubts = 0;
  std::vector<float> doubt_in_radii;
  facts_.max = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d off = truth_.position[i] - now.position[i];
    double error = off.norm();
    if (!(error < 1e30)) error = 1e30;  // what is not finite is as wrong as can be
    const double doubt = exact_ ? 0 : (truth_.position[i] - neighbour_.position[i]).norm();
    GhostInstance ghost{};
    for (int k = 0; k < 3; ++k) {
      ghost.body[k] = static_cast<float>(now.position[i][k]);
      ghost.offset[k] = static_cast<float>(off[k]);
    }
    ghost.radius = static_cast<float>(radius[i]);
    ghost.opacity = static_cast<float>(1 - smooth_step(0.25, 1, doubt / radius[i]));
    ghosts.push_back(ghost);
    errors.push_back(static_cast<float>(error));
    doubt_in_radii.push_back(static_cast<float>(doubt / radius[i]));
    sum += error * error;
    doubts += doubt * doubt;
    facts_.max = std::max(facts_.max, error);
  }
  facts_.rms = count ? std::sqrt(sum / static_cast<double>(count)) : 0;
  facts_.doubt = count ? std::sqrt(doubts / static_cast<double>(count)) : 0;
  if (quantile(doubt_in_radii, 0.5) > 1) {
    facts_.lack = "its own error is beyond a radius, as that of any reference would be";
    world.publisher().set_errors({});
    return {};
  }
  world.publisher().set_errors(std::move(errors));
  return ghosts;
}

}  // namespace collidoscope
