#include "sim_cuda/world.h"

#include <optional>
#include <stdexcept>
#include <utility>

#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/run/settled_state.h"
#include "sim_cuda/run/simulation.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

World::World(const Scene& scene, const RunOptions& options, const RunState* start, const BodyIdMap& ids) {
  with_allocation_context("creating a world", [&] {
    std::optional<RunState> rest;
    if (start == nullptr && needs_presimulation(valid(scene)))
      start = &rest.emplace(settled_state(scene, options));
    run_ = std::make_unique<Simulation>(scene, options, start, ids);
    if (start != nullptr) restore(*start, ids);
  });
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

const Scene& World::scene() const { return run_->scene; }
const InitialBodies& World::initial() const { return run_->initial; }
const RunOptions& World::options() const { return run_->options; }
Effects World::effects() const { return run_->effects; }
int World::substeps() const { return run_->substeps; }
double World::substeps_missed() const { return run_->substeps_missed; }

WorldInfo World::info() const {
  const Executor& executor = run_->executor;
  return {.on_gpu = executor.on_device(),
          .gpu = executor.gpu(),
          .device_name = executor.device_name(),
          .tuned = run_->tuned().used != nullptr ? tuned_text(*run_->tuned().used) : "",
          .tuned_rejection = run_->tuned().rejection,
          .key_bits = has_morton_keys(run_->options.broad_phase) ? executor.options().key_bits : 0,
          .allocated_bytes = executor.allocated_bytes(),
          .broad_phase_bytes = run_->runner().pipeline().broad_phase_bytes()};
}

TuningConditions World::tuning_conditions() const { return run_->tuning_conditions(); }

std::map<std::string, std::int64_t> World::buffers() const { return run_->executor.bytes_by_name(); }

StateValidation& World::validation() { return run_->validation; }
const StateValidation& World::validation() const { return run_->validation; }
ContactRecords& World::records() { return run_->records; }
TreeProbe& World::tree() { return run_->tree; }
Publisher& World::publisher() { return run_->publisher; }

void World::step(int count) {
  for (int k = 0; k < count && !run_->validation.paused(); ++k) {
    run_->executor.throw_if_cancelled_between_steps();
    run_->step(1);
    run_->require_known_stages();
  }
}
std::int64_t World::steps() const { return run_->steps(); }
double World::time() const { return run_->time(); }

RunState World::state() { return run_->state(); }
CopiedRunState World::copy_state() { return run_->copy_state(); }
void World::restore(World& other) { restore(other.state()); }
void World::restore(const RunState& other, const BodyIdMap& ids) { run_->restore(other, ids); }
void World::mark() { run_->mark(); }
bool World::rewind() { return run_->rewind(); }
std::uint64_t World::state_hash() { return run_->pipeline().state_hash(); }
StateHashes World::hashes() { return run_->records.hashes(); }
BodyStates World::bodies() { return run_->pipeline().bodies(); }

void World::detect() { run_->detect(); }
std::optional<PairCheck> World::pair_check() { return run_->pipeline().broad_phase().pair_check(); }
std::vector<std::pair<std::uint32_t, std::uint32_t>> World::pairs() { return run_->pipeline().pairs(); }

StepStats World::measure() {
  detect();  // the lists are now those of the current state, without speculative contacts
  const StepControl now = run_->pipeline().control();
  const bool stepped = run_->stepped();  // otherwise there are no committed counts
  StepStats stats;
  stats.step = run_->steps();
  stats.bodies = static_cast<std::int64_t>(run_->initial.size());
  stats.pairs = stepped ? now.pairs_committed : now.pairs;
  stats.touching = now.contacts;
  stats.speculative = stepped ? now.contacts_committed : now.contacts;
  stats.uncoloured_contacts = stepped ? now.uncoloured_committed : 0;
  stats.bounce_cap = stepped ? now.bounce_caps_committed : 0;
  run_->pipeline().measure(stats);
  return stats;
}

BodyReport World::inspect(std::uint32_t id) {
  if (id >= run_->initial.size()) throw std::out_of_range("inspect: there is no body " + std::to_string(id));
  detect();
  return run_->pipeline().inspect(id, run_->level_ordered_tree());
}

void World::set_launch_shape(LaunchShape shape) {
  run_->set_launch_shapes(shape, StageShapes(run_->options.stage_shapes));
}
void World::set_stage_shapes(const StageShapes& by_stage) {
  run_->set_launch_shapes(run_->options.shape, by_stage);
}
LaunchShape World::launch_shape() const { return run_->options.shape; }

namespace {

/// Keeps only the stages of a step, and counts the launches of all its runs.
RunTimes of_step(RunTimes times, int runs) {
  std::erase_if(times.stages, [](const StageTime& s) {
    return s.name == "measure" || s.name == "hash" || s.name == "publish" || s.name == "inspect" ||
           s.name == "tree" || s.name == "quality";
  });
  for (StageTime& s : times.stages) s.launches *= runs;
  return times;
}

}  // namespace

RunTimes World::times() const {
  return of_step(run_->executor.clock().times(), run_->pipeline().runs_per_step());
}

RunTimes World::latest_times() const {
  return of_step(run_->executor.clock().latest(), run_->pipeline().runs_per_step());
}

}  // namespace collidoscope
