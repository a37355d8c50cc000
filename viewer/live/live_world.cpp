#include "viewer/live/live_world.h"

#include <fmt/format.h>

#include <chrono>

#include "sim_cuda/core/error.h"
#include "sim_cuda/guard/frozen.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/stability/hard_run.h"

namespace collidoscope {
namespace {

/// Guards decide no state, so they are no change of it.
Settings without_guards(Settings wish) {
  if (wish.effects) wish.effects->guards = wish.guards.has_value();
  return wish;
}

}  // namespace

Settings settings_of(const World& world) {
  const Scene& scene = world.scene();
  const RunOptions& options = world.options();
  Settings s;
  s.bodies = static_cast<std::int64_t>(world.initial().size());
  if (scene.generators.size() == 1) {
    const BoxCollider& generator = scene.generators[0];
    s.bodies = generator.count;
    s.radius_max = generator.radius_max;
    s.seed = generator.seed;
    s.variant = generator.variant;
  }
  s.time_step = scene.physics.time_step;
  s.restitution = scene.materials[0].restitution;
  s.integrator = scene.physics.integrator;
  s.rotation_update = scene.physics.rotation_update;
  s.precision = scene.physics.precision;
  s.solver = scene.physics.solver;
  s.substeps = scene.physics.substeps;
  s.iterations = scene.physics.iterations;
  s.effects = scene.physics.effects;
  if (world.effects().guards) s.guards = scene.physics.guards.value_or(Guards{}).on_failure;
  s.executor = options.executor;
  s.shape = options.shape;
  s.broad_phase = options.broad_phase;
  return s;
}

Change change_between(const Settings& now, const Settings& wish) {
  Change change;
  const auto set = [](auto& member, const auto& before, const auto& after) {
    if (before != after) member = after;
  };
  set(change.bodies, now.bodies, wish.bodies);
  set(change.radius_max, now.radius_max, wish.radius_max);
  set(change.seed, now.seed, wish.seed);
  set(change.variant, now.variant, wish.variant);
  set(change.time_step, now.time_step, wish.time_step);
  set(change.restitution, now.restitution, wish.restitution);
  set(change.integrator, now.integrator, wish.integrator);
  set(change.rotation_update, now.rotation_update, wish.rotation_update);
  set(change.precision, now.precision, wish.precision);
  set(change.solver, now.solver, wish.solver);
  if (now.substeps != wish.substeps) change.substeps.emplace(wish.substeps);
  set(change.iterations, now.iterations, wish.iterations);
  if (now.effects != wish.effects) change.effects.emplace(wish.effects);
  set(change.blocks, now.shape.blocks, wish.shape.blocks);
  set(change.threads, now.shape.threads, wish.shape.threads);
  set(change.broad_phase, now.broad_phase, wish.broad_phase);
  return change;
}

void record_step(World& world, const StepStats* measured, History& history) {
  HistoryStep entry;
  entry.step = world.steps();
  // Worlds time even-numbered steps plain and odd-numbered ones stage by stage, counted from 0.
  const bool instrumented = world.steps() % 2 == 0;
  const RunTimes times = world.latest_times();
  if (!instrumented && times.steps_timed > 0) entry.plain_ms = times.step_last_ms;
  if (measured != nullptr) {
    entry.stats = *measured;
    entry.measured = true;
  }
  entry.nodes = world.tree_nodes();
  entry.allocated_bytes = world.allocated_bytes();
  history.add(std::move(entry), instrumented ? times.stages : std::vector<StageTime>{});
}

LiveWorld::LiveWorld(const Scene& scene, const RunOptions& options)
    : world_(std::make_unique<World>(scene, options)) {}

LiveWorld::LiveWorld(World world)
    : world_(std::make_unique<World>(std::move(world))), began_(world_->steps()) {}

void LiveWorld::replace(std::unique_ptr<World> world) {
  world_ = std::move(world);
  ++generation_;
  stats_known_ = hash_known_ = false;
  level_sizes_step_ = -1;
}

std::string LiveWorld::apply(const Settings& wish, const RunState* rest) {
  if (wish.guards != settings().guards) set_guards(wish.guards);
  const Settings others = without_guards(wish);
  const Settings now = settings();
  if (others == now) return "";
  RunOptions options = world_->options();
  options.executor = others.executor;
  return apply(change_between(now, others), options, rest);
}

std::optional<Scene> LiveWorld::next_run(const Settings& wish) const {
  Settings now = settings();
  now.guards = wish.guards;
  Change change = change_between(without_guards(now), without_guards(wish));
  change.step = world_->steps();
  std::optional<Scene> next = collidoscope::next_run(*world_, change);
  return next ? std::optional(valid(*next)) : std::nullopt;
}

/// They decide no state, so nobody need be told that they were turned.
void LiveWorld::set_guards(std::optional<OnFailure> wish) {
  Scene scene = world_->scene();
  Physics& physics = scene.physics;
  if (physics.guards) guards_ = *physics.guards;
  if (wish) {
    physics.guards = guards_;
    physics.guards->on_failure = *wish;
    if (physics.effects) physics.effects->guards = true;
  } else {
    leave_out_guards(physics);
  }
  const RunState state = world_->state();
  replace(std::make_unique<World>(scene, RunOptions(world_->options()), &state));
}

void LiveWorld::freeze(std::uint32_t body) {
  RunState state = world_->state();
  collidoscope::freeze(state, body, world_->initial(), world_->scene().physics.guards.value_or(Guards{}));
  replace(std::make_unique<World>(Scene(world_->scene()), RunOptions(world_->options()), &state));
  edited_ = true;
}

std::string LiveWorld::apply(Change change) { return apply(std::move(change), world_->options(), nullptr); }

std::string LiveWorld::apply(Change change, const RunOptions& options, const RunState* rest) {
  const auto start = std::chrono::steady_clock::now();
  change.step = world_->steps();
  Scene after = world_->scene();
  RunOptions unused = options;
  last_ids_ = make_change(change, after, unused);
  const bool again = begins_another_run(world_->scene(), after);
  const bool new_bodies = change.radius_max || change.seed || change.variant;
  const std::optional<Box> old_box = world_->initial().box;
  std::unique_ptr<World> next = changed_world(*world_, change, options, rest);
  std::string said;
  if (again) {
    const std::optional<Box>& box = next->initial().box;
    if (!new_bodies && box && old_box && box->max != old_box->max)
      said = fmt::format("restarted: the box of the variant goes with N, {:.4g} m now",
                         box->max.x() - box->min.x());
    else if (world_->steps() > 0)
      said = "restarted: these are other bodies";
    history_.clear();
    edited_ = false;
  } else if (change.physical() && world_->steps() > 0) {
    edited_ = true;
  }
  const bool recorded = change.physical() || change.broad_phase || change.blocks || change.threads;
  if (recorded) record_change(changes_, std::move(change));
  if (again) record_restart(changes_);
  if (next == nullptr) return "";  // (B, T) alone
  replace(std::move(next));
  change_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return said;
}

std::string LiveWorld::changes_text() {
  if (!world_->frozen().empty())
    throw InputError("bodies were frozen, and no list of changes says so; a snapshot keeps it");
  return write_changes({changes_, RecordedEnd{world_->steps(), state_hash()}}, world_->scene());
}

void LiveWorld::open(World world, Script script) {
  replace(std::make_unique<World>(std::move(world)));
  script_ = std::move(script);
  next_in_script_ = 0;
  while (next_in_script_ < script_.changes.size() && script_.changes[next_in_script_].step <= world_->steps())
    ++next_in_script_;
  began_ = world_->steps();
  changes_.clear();
  history_.clear();
  last_ids_.clear();
  edited_ = false;
}

void LiveWorld::play_script() {
  for (; next_in_script_ < script_.changes.size() && script_.changes[next_in_script_].step == world_->steps();
       ++next_in_script_)
    apply(script_.changes[next_in_script_]);
}

void LiveWorld::restart(const RunState* rest) {
  if (scripted()) {
    HardRun again(script_.scene, script_.options, script_.changes);
    return open(std::move(again.world()), Script(script_));
  }
  replace(std::make_unique<World>(Scene(world_->scene()), RunOptions(world_->options()), rest));
  record_restart(changes_);
  if (began_ > 0 && changes_.empty()) changes_.emplace_back();  // a change of state 0 begins anew
  history_.clear();
  last_ids_.clear();
  edited_ = false;
}

bool LiveWorld::step(bool measured) {
  const std::int64_t before = world_->steps();
  world_->step();
  stats_known_ = hash_known_ = false;
  if (world_->steps() == before) return false;  // a guard has paused it
  record_step(*world_, measured ? &stats() : nullptr, history_);
  play_script();
  return true;
}

const StepStats& LiveWorld::stats() {
  if (!stats_known_) stats_ = world_->measure();
  stats_known_ = true;
  return stats_;
}

std::uint64_t LiveWorld::state_hash() {
  if (!hash_known_) hash_ = world_->state_hash();
  hash_known_ = true;
  return hash_;
}

const std::vector<std::int64_t>& LiveWorld::level_sizes(bool exact) {
  if (level_sizes_step_ < 0 || (exact && level_sizes_step_ != world_->steps())) {
    level_sizes_ = world_->tree_level_sizes();
    level_sizes_step_ = world_->steps();
  }
  return level_sizes_;
}

}  // namespace collidoscope
