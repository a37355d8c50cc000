#include "sim_cuda/run/simulation.h"

#include <algorithm>
#include <utility>

#include "sim_cuda/broad_phase/key_bits.h"
#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/run/frozen.h"
#include "sim_cuda/run/step_estimate.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/joint_substeps.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/placed_joint.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

RunOptions with_key_bits(RunOptions options, const InitialBodies& bodies, const RunState* start) {
  if (options.key_bits == 0)
    options.key_bits = key_bits_called_for(
        bodies, start != nullptr ? start->bodies.position : bodies.position, options.sort);
  return options;
}

/// How long the lists of a pipeline are at first: about four times what a packing of such spheres shows, so
/// that most scenes never grow.
Capacity first_capacity(const RunOptions& options, const InitialBodies& bodies) {
  const auto usual = std::max<std::int64_t>(1024, 4 * static_cast<std::int64_t>(bodies.size()));
  const std::int64_t guess = options.initial_pair_capacity > 0 ? options.initial_pair_capacity : usual;
  return {guess, guess};
}

/// Of all settings, but not of which bodies there are; 0 where nothing can sleep.
std::uint64_t settings_hash(Scene scene) {
  if (!scene.physics.sleep) return 0;
  leave_out_guards(scene.physics);  // they decide nothing
  scene.bodies.clear();
  scene.added.clear();
  scene.joints.clear();
  for (BoxCollider& generator : scene.generators) {
    generator.count = 0;
    generator.without.clear();
  }
  std::uint64_t hash = 0;
  for (const char letter : write_scene(scene)) hash = mix64(hash ^ static_cast<unsigned char>(letter));
  return hash;
}

}  // namespace

Simulation::Simulation(const Scene& s, const RunOptions& asked, const RunState* start, const BodyIds& ids)
    : scene(valid(s)),
      options(asked),
      initial((expect_room_for_bodies(scene, options), initial_bodies(scene, options.cancellation))),
      executor(with_key_bits(asked, initial, start)),
      effects(scene.physics.effects.value_or(effects_called_for(scene, initial))),
      substeps(substeps_of(scene, initial)),
      guards(*this, effects.guards),
      undo_(executor),
      current_tree_(executor, static_cast<std::int64_t>(initial.size())),
      runner_(executor,
              (expect_room_for_step(executor, {options.broad_phase, scene, initial, effects, substeps, start,
                                               ids, first_capacity(options, initial)}),
               make()),
              first_capacity(options, initial)) {}

// ---- pipeline ----

std::unique_ptr<Pipeline> Simulation::make() {
  const std::vector<std::uint32_t>& frozen = guards.frozen();
  auto next = frozen.empty() ? make_pipeline(executor, options.broad_phase, scene, initial, effects, substeps)
                             : make_pipeline(executor, options.broad_phase, scene,
                                             with_frozen(initial, frozen), effects, substeps);
  next->before_writing([this](const StepControl& control) {
    undo_.before_writing(runner_.pipeline(), control,
                         seconds_to_solve(executor, scene.physics, static_cast<double>(initial.size()),
                                          control.contacts, substeps));
  });
  records.set_up(*next);
  guards.set_up(*next);
  return next;
}

Pipeline& Simulation::pipeline() {
  recover();
  return runner_.pipeline();
}

void Simulation::replace_pipeline() {
  auto next = make();
  next->reserve(pipeline().capacity());
  runner_.replace(std::move(next));
}

void Simulation::set_launch_shape(LaunchShape shape) {
  executor.set_shape(shape);
  options.shape = shape;
  runner_.forget_recorded();  // a recorded step has the old shape in it
}

// ---- steps ----

void Simulation::step(int count) {
  for (int done = 0; done < count && !guards.paused();) {
    recover();
    guards.before_step();
    const std::uint32_t first_run = runner_.committed();
    if (const std::optional<FirstFound> found = advance())
      guards.resolve(*found, first_run);
    else
      ++done;
  }
}

std::optional<FirstFound> Simulation::advance() {
  const bool with_events = steps_ % 2 == 1;
  detected_ = false;
  struct AtItsEnd {  // even where the clock then finds no memory to note its time in
    Simulation& run;
    std::uint32_t target;
    bool found = false;
    ~AtItsEnd() {
      if (found || run.runner_.committed() != target) return;
      ++run.steps_;
      run.stepped_ = true;
      run.records.step_made();
    }
  } count_it{*this, runner_.next()};
  undo_.begin_step(runner_.pipeline().runs_per_step());
  try {
    const std::optional<FirstFound> found =
        while_doing("making a step", [&] { return runner_.step(with_events); });
    count_it.found = found.has_value();
    undo_.end_step();
    return found;
  } catch (const Cancelled&) {
    undo_.leave_step();
    throw;
  } catch (...) {
    undo_.end_step();
    throw;
  }
}

void Simulation::recover() {
  if (!executor.interrupted()) return;
  if (executor.on_device() || options.cancellation->requested()) throw Cancelled();
  const Executor::Uninterrupted whole(executor);
  executor.resume();
  undo_.undo();
  const StepControl counts = runner_.pipeline().control();
  const RunState before = state();
  runner_.remake([this] { return make(); });
  put(before);
  runner_.pipeline().set_counts(counts);
  records.recovered();
  current_tree_.forget();
  guards.recovered();
}

void Simulation::detect() {
  recover();
  if (detected_) return runner_.expect_memory();
  records.keep();
  while_doing("finding pairs", [&] { runner_.detect(); });
  detected_ = true;
  current_tree_.forget();
}

// ---- state ----

RunState Simulation::state() {
  return {steps_,
          pipeline().bodies(),
          pipeline().static_impulses(),
          pipeline().save_warm_start(),
          settings_hash(scene),
          guards.frozen(),
          time()};
}

void Simulation::adopt(const RunState& other, const BodyIds& ids) {
  recover();
  const Executor::Uninterrupted whole(executor);
  RunState state = renumbered(other, ids, pipeline().bodies());
  runner_.forget_recorded();  // what the solver remembers may move
  guards.set_frozen(state.frozen);
  for (const std::uint32_t body : state.frozen) {
    state.bodies.velocity[body].setZero();
    state.bodies.angular_velocity[body].setZero();
  }
  if (other.settings != settings_hash(scene)) state.warm_start.sleep_timer.clear();
  put(state);
  stepped_ = false;
  guards.adopted();
}

void Simulation::put(const RunState& state) {
  runner_.pipeline().set_bodies(state.bodies, state.static_impulses);
  runner_.pipeline().load_warm_start(state.warm_start);
  steps_ = state.steps;
  // Where all steps were of this length, their number alone says it, without a sum's rounding.
  const bool one_length = state.time == static_cast<double>(state.steps) * scene.physics.time_step;
  known_time_ = one_length ? KnownTime{} : KnownTime{state.steps, state.time};
  detected_ = false;
  records.state_replaced();
}

double Simulation::time() const {
  return known_time_.time + static_cast<double>(steps_ - known_time_.step) * scene.physics.time_step;
}

}  // namespace collidoscope
