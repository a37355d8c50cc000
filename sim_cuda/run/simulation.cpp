#include "sim_cuda/run/simulation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "sim_cuda/broad_phase/key_bits.h"
#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"
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
    options.key_bits =
        automatic_key_bits(bodies, start != nullptr ? start->bodies.position : bodies.position, options.sort);
  return options;
}

/// Initial list capacities: about four times the pairs of a sphere packing, so most scenes never grow.
Capacity first_capacity(const RunOptions& options, const InitialBodies& bodies) {
  const auto usual = std::max<std::int64_t>(1024, 4 * static_cast<std::int64_t>(bodies.size()));
  const std::int64_t guess = options.initial_pair_capacity > 0 ? options.initial_pair_capacity : usual;
  return {guess, guess};
}

}  // namespace

Simulation::Simulation(const Scene& s, const RunOptions& asked, const RunState* start, const BodyIdMap& ids)
    : scene(valid(s)),
      options(asked),
      initial((require_memory_for_bodies(scene, options), initial_bodies(scene, options.cancellation))),
      executor(with_key_bits(asked, initial, start)),
      effects(scene.physics.effects.value_or(required_effects(scene, initial))),
      substeps(substeps_of(scene, initial)),
      substeps_missed(collidoscope::substeps_missed(scene, initial)),
      validation(*this, effects.guards),
      undo_(executor),
      mark_(executor),
      bvh_cache_(executor, static_cast<std::int64_t>(initial.size())),
      runner_(executor,
              (require_memory_for_step(executor, {options.broad_phase, scene, initial, effects, substeps,
                                                  start, ids, first_capacity(options, initial)}),
               make()),
              first_capacity(options, initial)) {
  tuned_ = choose_tuned(options.tuned_shapes, tuning_conditions());
  apply_shapes(options.shape, options.stage_shapes);
}

// ---- pipeline ----

std::unique_ptr<Pipeline> Simulation::make() {
  const std::vector<std::uint32_t>& frozen = validation.frozen();
  auto next = frozen.empty() ? make_pipeline(executor, options.broad_phase, scene, initial, effects, substeps)
                             : make_pipeline(executor, options.broad_phase, scene,
                                             with_static_bodies(initial, frozen), effects, substeps);
  next->before_writing([this](const StepControl& control) {
    undo_.before_writing(runner_.pipeline(), control,
                         estimate_solve_seconds(executor, scene.physics, static_cast<double>(initial.size()),
                                                control.contacts, substeps));
  });
  records.set_up(*next);
  validation.set_up(*next);
  return next;
}

Pipeline& Simulation::pipeline() {
  recover();
  return runner_.pipeline();
}

void Simulation::replace_pipeline() {
  auto next = make();
  next->reserve(pipeline().capacity());
  mark_.clear();
  runner_.replace(std::move(next));
}

void Simulation::set_launch_shapes(LaunchShape shape, const StageShapes& by_stage) {
  apply_shapes(shape, by_stage);
  options.shape = shape;
  options.stage_shapes = by_stage;
  knows_stages_ = false;
  runner_.discard_graphs();  // recorded steps contain the old shapes
}

void Simulation::apply_shapes(LaunchShape shape, const StageShapes& by_stage) {
  if (tuned_.used != nullptr && shape == LaunchShape{} && by_stage.empty())
    executor.set_shapes(tuned_.used->shape, tuned_.used->stages, true);
  else
    executor.set_shapes(shape, by_stage);
}

TuningConditions Simulation::tuning_conditions() const {
  const bool on_gpu = executor.on_device();
  return {.device = executor.device_name(),
          .driver = executor.driver(),
          .build = build_name(on_gpu),
          .cpu_threads = on_gpu ? 0 : executor.cpu_threads(),
          .broad_phase = options.broad_phase,
          .solver = std::string(name_of(solver_names, scene.physics.solver)),
          .precision = std::string(name_of(precision_names, scene.physics.precision)),
          .effects = names_of(effects),
          .bodies = static_cast<std::int64_t>(initial.size()),
          .scene = scene.name};
}

void Simulation::require_known_stages() {
  if (knows_stages_ || options.stage_shapes.empty()) return;
  std::vector<std::string> names;
  for (const StageTime& stage : executor.clock().latest().stages) names.push_back(stage.name);
  for (const auto& [stage, shape] : options.stage_shapes)
    if (std::ranges::find(names, stage) == names.end())
      throw InputError(fmt::format("stage shapes: {}: not a stage of this run, expected one of {}", stage,
                                   fmt::join(names, ", ")));
  knows_stages_ = true;
}

// ---- steps ----

void Simulation::step(int count) {
  for (int done = 0; done < count && !validation.paused();) {
    recover();
    validation.before_step();
    const std::uint32_t first_run = runner_.committed();
    if (const std::optional<FirstViolation> found = advance())
      validation.resolve(*found, first_run);
    else
      ++done;
  }
}

std::optional<FirstViolation> Simulation::advance() {
  const bool with_events = steps_ % 2 == 1;
  detected_ = false;
  struct CountStepOnExit {  // also if the clock then fails to allocate memory
    Simulation& run;
    std::uint32_t target;
    bool found = false;
    ~CountStepOnExit() {
      if (found || run.runner_.committed() != target) return;
      ++run.steps_;
      run.stepped_ = true;
      run.records.step_made();
    }
  } count_step{*this, runner_.next()};
  records.begin_step();
  undo_.begin_step(runner_.pipeline().runs_per_step());
  try {
    const std::optional<FirstViolation> found =
        with_allocation_context("computing a step", [&] { return runner_.step(with_events); });
    count_step.found = found.has_value();
    undo_.end_step();
    return found;
  } catch (const Cancelled&) {
    undo_.cancel_step();
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
  runner_.recreate([this] { return make(); });
  write_state(before);
  runner_.pipeline().set_counts(counts);
  records.recovered();
  bvh_cache_.invalidate();
  validation.recovered();
}

void Simulation::detect() {
  recover();
  if (detected_) return runner_.require_memory();
  records.keep();
  with_allocation_context("finding pairs", [&] { runner_.detect(); });
  detected_ = true;
  bvh_cache_.invalidate();
}

// ---- state ----

CopiedRunState Simulation::copy_state() {
  CopiedRunState copied;
  copied.known.steps = steps_;
  copied.known.static_impulses = pipeline().static_impulses();
  copied.known.settings = settings_hash(scene);
  copied.known.frozen = validation.frozen();
  copied.known.time = time();
  pipeline().save_bodies(copied.bodies);
  pipeline().save_warm_start(copied.warm_start);
  return copied;
}

void Simulation::restore(const RunState& other, const BodyIdMap& ids) {
  recover();
  const Executor::Uninterrupted whole(executor);
  RunState state = remap_bodies(other, ids, pipeline().bodies());
  runner_.discard_graphs();  // buffers of the warm-start data may be reallocated
  validation.set_frozen(state.frozen);
  for (const std::uint32_t body : state.frozen) {
    state.bodies.velocity[body].setZero();
    state.bodies.angular_velocity[body].setZero();
  }
  if (other.settings != settings_hash(scene)) state.warm_start.sleep_timer.clear();
  write_state(state);
  stepped_ = false;
  validation.restored();
}

void Simulation::mark() {
  recover();
  mark_.set(pipeline());
  marked_ = {steps_, known_time_};
}

bool Simulation::rewind() {
  recover();
  const Executor::Uninterrupted whole(executor);
  if (!mark_.rewind(pipeline())) return false;
  runner_.discard_runs();
  steps_ = marked_.steps;
  known_time_ = marked_.known_time;
  detected_ = stepped_ = false;
  records.state_replaced();
  bvh_cache_.invalidate();
  validation.restored();
  return true;
}

void Simulation::write_state(const RunState& state) {
  mark_.clear();  // the arrays may become shorter than the marked ones
  runner_.pipeline().set_bodies(state.bodies, state.static_impulses);
  runner_.pipeline().load_warm_start(state.warm_start);
  steps_ = state.steps;
  // If all steps had this length, time is step count * length, without accumulated rounding.
  const bool one_length = state.time == static_cast<double>(state.steps) * scene.physics.time_step;
  known_time_ = one_length ? KnownTime{} : KnownTime{state.steps, state.time};
  detected_ = false;
  records.state_replaced();
}

double Simulation::time() const {
  return known_time_.time + static_cast<double>(steps_ - known_time_.step) * scene.physics.time_step;
}

}  // namespace collidoscope
