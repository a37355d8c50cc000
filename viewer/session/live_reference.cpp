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

/// The scene with the present bodies of the world as a list.
Scene scene_of_now(World& world) {
  Scene scene = world.scene();
  const InitialBodies& initial = world.initial();
  const BodyStates now = world.bodies();
  scene.box = initial.box;
  scene.generators.clear();
  scene.body_files.clear();
  scene.extra_bodies.clear();
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

std::string problem_fingerprint(const World& world) {
  Effects effects = world.effects();
  effects.continuous_collision = false;
  Scene scene = with_setting(world.scene(), {}, effects);
  scene.physics.restitution_threshold.reset();
  return write_scene(scene);
}

void LiveReference::forget() {
  if (view_.name.empty()) return;
  const int version = version_ + 1;
  *this = {};
  version_ = version;
}

std::string LiveReference::unavailable_reason(std::int64_t bodies) {
  return bodies > max_bodies ? fmt::format("no reference for more than {} bodies", max_bodies) : "";
}

void LiveReference::follow(World& world, int generation) {
  if (generation == generation_ && world.steps() == steps_) return;
  const bool another = generation != generation_;
  const std::string problem = another ? problem_fingerprint(world) : problem_;
  generation_ = generation;
  ++version_;
  if (problem == problem_ && world.steps() == steps_ && !view_.name.empty())
    return;  // only a numerical setting changed
  problem_ = problem;
  begin(world);
}

void LiveReference::begin(World& world) {
  steps_ = world.steps();
  time_ = 0;
  exact_.reset();
  runs_.clear();
  states_known_ = false;
  view_ = {};
  view_.start_state = steps_;
  view_.name = "none";
  view_.unavailable_reason = unavailable_reason(static_cast<std::int64_t>(world.initial().size()));
  if (!view_.unavailable_reason.empty()) return;
  try {
    exact_ = std::make_unique<HardSpheres>(steps_ == 0 ? world.scene() : scene_of_now(world));
    view_.name = "event-driven hard spheres";
    return;
  } catch (const InputError&) {  // not a scene of hard spheres
  }
  Scene scene = world.scene();
  scene.physics.precision = Precision::f64;
  disable_guards(scene.physics);
  const RunState state = world.state();
  try {
    for (const int parts : {8, 4}) {
      scene.physics.time_step = world.scene().physics.time_step / parts;
      runs_.push_back({std::make_unique<World>(scene, world.options(), &state), parts});
    }
    view_.name = "double precision, 1/8 of the time step";
  } catch (const std::exception& error) {  // most likely out of memory
    runs_.clear();
    view_.unavailable_reason = error.what();
  }
}

/// Adapts the time step of a reference run to a new time step of the run: an integer fraction near the
/// present one.
void LiveReference::fit(Run& run, double dt) {
  const double now = run.world->scene().physics.time_step;
  run.parts = std::max(1, static_cast<int>(std::lround(dt / now)));
  if (std::abs(run.parts * now - dt) <= 1e-12 * dt) return;
  Change change;
  change.step = run.world->steps();
  change.settings.set<&Physics::time_step>(dt / run.parts);
  run.world = world_after_change(*run.world, change, run.world->options());
}

bool LiveReference::advance_to_next_step(double dt, double milliseconds) {
  if (!view_.known()) return true;
  const Deadline slice(milliseconds);
  if (!states_known_) compare();
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
  } catch (const std::exception& error) {  // out of memory while growing
    runs_.clear();
    view_.unavailable_reason = error.what();
  }
  return true;
}

void LiveReference::stepped(double dt) {
  if (view_.name.empty()) return;
  ++steps_;
  time_ += dt;
  for (Run& run : runs_) run.done = 0;
  states_known_ = false;
  ++version_;
}

/// Stores the reference state that corresponds to the present state of the run.
void LiveReference::compare() {
  states_known_ = true;
  if (exact_) reference_state_ = exact_->bodies();
  if (!runs_.empty()) {
    reference_state_ = runs_[0].world->bodies();
    coarser_state_ = runs_[1].world->bodies();
  }
}

std::vector<GhostInstance> LiveReference::ghosts(World& world, int generation) {
  follow(world, generation);
  std::vector<GhostInstance> ghosts;
  std::vector<float> errors;
  if (view_.known() && !states_known_) compare();
  if (view_.known() && exact_) {
    const double collisions = 2.0 * static_cast<double>(exact_->counts().pairs) /
                              static_cast<double>(std::max<std::size_t>(world.initial().size(), 1));
    if (exact_->zeno_point() && exact_->time() < time_)
      view_.unavailable_reason = exact_->zeno_line();
    else if (collisions > 20)
      view_.unavailable_reason = "Reference ended: after 20 collisions per sphere, rounding errors dominate";
  }
  if (!view_.known()) {
    world.publisher().set_errors({});
    return ghosts;
  }
  const BodyStates now = world.bodies();
  const std::vector<double>& radius = world.initial().radius;
  const std::size_t count = radius.size();
  double sum = 0, error_estimate_sum = 0;
  std::vector<float> error_estimate_in_radii;
  view_.max = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d off = reference_state_.position[i] - now.position[i];
    double error = off.norm();
    if (!(error < 1e30)) error = 1e30;  // non-finite errors count as very large
    const double error_estimate =
        exact_ ? 0 : (reference_state_.position[i] - coarser_state_.position[i]).norm();
    GhostInstance ghost{};
    for (int k = 0; k < 3; ++k) {
      ghost.body[k] = static_cast<float>(now.position[i][k]);
      ghost.offset[k] = static_cast<float>(off[k]);
    }
    ghost.radius = static_cast<float>(radius[i]);
    ghost.opacity = static_cast<float>(1 - smooth_step(0.25, 1, error_estimate / radius[i]));
    ghosts.push_back(ghost);
    errors.push_back(static_cast<float>(error));
    error_estimate_in_radii.push_back(static_cast<float>(error_estimate / radius[i]));
    sum += error * error;
    error_estimate_sum += error_estimate * error_estimate;
    view_.max = std::max(view_.max, error);
  }
  view_.rms = count ? std::sqrt(sum / static_cast<double>(count)) : 0;
  view_.error_estimate = count ? std::sqrt(error_estimate_sum / static_cast<double>(count)) : 0;
  if (quantile(error_estimate_in_radii, 0.5) > 1) {
    view_.unavailable_reason =
        "Reference ended: motion is chaotic, the error of the reference exceeds a body radius";
    world.publisher().set_errors({});
    return {};
  }
  world.publisher().set_errors(std::move(errors));
  return ghosts;
}

}  // namespace collidoscope
