#include "viewer/session/live_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/wall_clock.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/stability/hard_case_simulation.h"

namespace collidoscope {
namespace {

/// Settings without guards, which do not affect the state.
Settings without_guards(Settings request) {
  if (request.physics.effects) request.physics.effects->guards = request.guards.has_value();
  return request;
}

using Clock = std::chrono::steady_clock;

/// Whether a replay needs the change.
bool is_recorded(const Change& change) { return change.physical() || !change.settings.empty(); }

/// Notice about a restart. `steps`: number of steps of the previous run.
std::string restart_notice(const Change& change, const Scene& before, const World& next, std::int64_t steps) {
  if (!requires_restart(before, next.scene())) return "";
  const bool new_bodies =
      change.settings.any([](const auto& setting) { return setting.live == Live::restart; });
  const std::optional<Box> old_box = box_in_effect(before), box = next.initial().box;
  if (!new_bodies && box && old_box && box->max != old_box->max)
    return fmt::format("restarted: the box size depends on N and is now {:.4g} m",
                       box->max.x() - box->min.x());
  return steps > 0 ? "restarted with new bodies" : "";
}

}  // namespace

Settings settings_of(const Scene& scene, const RunOptions& options, std::int64_t bodies) {
  Settings s{settings_of(scene, options), {}};
  if (scene.generators.size() != 1) s.generator.count = bodies;
  const Physics& physics = scene.physics;
  if (physics.effects ? physics.effects->guards : physics.guards.has_value())
    s.guards = physics.guards.value_or(ValidationSettings{}).on_failure;
  return s;
}

Settings settings_of(const World& world) {
  return settings_of(world.scene(), world.options(), static_cast<std::int64_t>(world.initial().size()));
}

Change change_between(const Settings& now, const Settings& request) {
  Change change;
  change.settings = difference(now, request);
  return change;
}

void record_step(World& world, const StepStats* measured, History& history) {
  HistoryStep entry;
  entry.step = world.steps();
  // A World times even-numbered steps as a whole and odd-numbered steps by stage, counted from 0.
  const bool instrumented = world.steps() % 2 == 0;
  const RunTimes times = world.latest_times();
  if (!instrumented && times.steps_timed > 0) entry.plain_ms = times.step_last_ms;
  if (measured != nullptr) {
    entry.stats = *measured;
    entry.measured = true;
  }
  entry.nodes = world.tree().nodes();
  entry.allocated_bytes = world.info().allocated_bytes;
  history.add(std::move(entry), instrumented ? times.stages : std::vector<StageTime>{});
}

LiveWorld::LiveWorld(const Scene& scene, const RunOptions& options)
    : world_(std::make_unique<World>(scene, options)) {
  begin_record();
}

LiveWorld::LiveWorld(World world) : world_(std::make_unique<World>(std::move(world))) { begin_record(); }

/// Starts a new record of changes at the present state.
void LiveWorld::begin_record() {
  began_ = world_->steps();
  first_scene_ = world_->scene();
  first_settings_ = settings();
  changes_.clear();
  pending_.reset();
  history_.clear();
  last_id_map_.clear();
  edited_ = false;
  forget_other_run();
  timeline_.begin(*world_);
  lanes_.begin(world_->steps());
  found_.clear();
}

void LiveWorld::replace(std::unique_ptr<World> world) {
  world_ = std::move(world);
  ++generation_;
  stats_known_ = hash_known_ = false;
  level_sizes_step_ = -1;
}

std::string LiveWorld::apply(const Settings& request, const RunState* rest, bool extends_last) {
  if (request.guards != settings().guards) set_guards(request.guards);
  const Settings others = without_guards(request), now = settings();
  if (others == now) return "";
  const Clock::time_point start = Clock::now();
  const bool other_executor = others.run.executor != now.run.executor;
  Change change = change_between(now, others);
  change.step = world_->steps();
  if (change.only_launch_shape() && !other_executor) {
    world_after_change(*world_, change, world_->options());
    if (!pending_) {
      record_change(changes_, change, extends_last);
      return "";
    }
    changes_.back().settings.merge(change.settings);
    return "";
  }
  Scene after = world_->scene();
  RunOptions unused;
  BodyIdMap ids = apply_change(change, after, unused);
  const bool first = !pending_;
  if (first) pending_.emplace(Pending{save_run(*world_), now, edited_});
  if (!first) {
    change = change_between(pending_->settings, others);
    change.step = world_->steps();
  }
  RunOptions options = pending_->run.options;
  options.executor = others.run.executor;
  std::unique_ptr<World> next;
  try {
    next = world_after_change(pending_->run, change, options, rest);
  } catch (...) {
    if (first) pending_.reset();
    throw;
  }
  if (change.physical()) branch(world_->steps());
  last_id_map_ = std::move(ids);
  if (!first) {
    edited_ = pending_->edited;
    changes_.pop_back();
  }
  const Scene before = world_->scene();
  if (is_recorded(change))
    changes_.push_back(change);
  else
    pending_.reset();
  const std::string notice = restart_notice(change, before, *next, world_->steps());
  made(change, before, std::move(next));
  change_seconds_ = seconds_since(start);
  return notice;
}

std::optional<Scene> LiveWorld::scene_after_restart(const Settings& request) const {
  Settings now = settings();
  now.guards = request.guards;
  Change change = change_between(without_guards(now), without_guards(request));
  change.step = world_->steps();
  std::optional<Scene> next = collidoscope::scene_after_restart(*world_, change);
  return next ? std::optional(valid(*next)) : std::nullopt;
}

/// Guards do not affect the state, so this is not recorded as a change.
void LiveWorld::set_guards(std::optional<OnFailure> request) {
  Scene scene = world_->scene();
  Physics& physics = scene.physics;
  if (physics.guards) guards_ = *physics.guards;
  if (request) {
    physics.guards = guards_;
    physics.guards->on_failure = *request;
    if (physics.effects) physics.effects->guards = true;
  } else {
    disable_guards(physics);
  }
  const RunState state = world_->state();
  replace(std::make_unique<World>(scene, RunOptions(world_->options()), &state));
  pending_.reset();
}

void LiveWorld::freeze(std::uint32_t body) {
  Change change;
  change.freeze = {body};
  apply(std::move(change));
}

std::string LiveWorld::apply(Change change) {
  change.step = world_->steps();
  const Scene before = world_->scene();
  Scene after = before;
  RunOptions unused;
  BodyIdMap ids = apply_change(change, after, unused);
  std::unique_ptr<World> next = world_after_change(*world_, change, world_->options());
  if (change.physical()) branch(world_->steps());
  last_id_map_ = std::move(ids);
  pending_.reset();
  if (is_recorded(change)) record_change(changes_, change);
  if (next == nullptr) return "";  // only (B, T) changed
  const std::string notice = restart_notice(change, before, *next, world_->steps());
  made(change, before, std::move(next));
  return notice;
}

/// `next`: the run after `change`; `before`: the previous scene. Records the change.
void LiveWorld::made(const Change& change, const Scene& before, std::unique_ptr<World> next) {
  if (requires_restart(before, next->scene())) {
    history_.clear();
    edited_ = false;
    record_restart(changes_);
  } else if (change.physical() && world_->steps() > 0) {
    edited_ = true;
  }
  const bool restarts = requires_restart(before, next->scene());
  replace(std::move(next));
  if (restarts) {
    forget_other_run();
    timeline_.begin(*world_);
    lanes_.begin(world_->steps());
    found_.clear();
  } else if (change.physical())
    timeline_.record_change(*world_);
  if (world_->steps() > 0) return;
  pending_.reset();
  collapse();
}

/// Combines all changes at state 0 into one, if possible.
void LiveWorld::collapse() {
  if (changes_.empty() && began_ == 0) return;
  if (!std::ranges::all_of(changes_, [](const Change& change) { return change.freeze.empty(); })) return;
  Settings now = settings(), first = first_settings_;
  first.guards = now.guards;
  Change change = change_between(without_guards(first), without_guards(now));
  if (!generated()) change.settings.get<&BoxCollider::count>().reset();  // implied by the body lists
  std::optional<Change> one = merged_change(first_scene_, world_->scene(), std::move(change));
  if (!one) return;
  changes_.clear();
  // A change at state 0 is recorded as a restart if the run started from a snapshot.
  if (is_recorded(*one) || began_ > 0) changes_.push_back(std::move(*one));
}

std::string LiveWorld::changes_text() {
  return write_changes({changes_, RecordedEnd{world_->steps(), state_hash()}}, world_->scene());
}

void LiveWorld::open(World world, Script script) {
  replace(std::make_unique<World>(std::move(world)));
  script_ = std::move(script);
  next_in_script_ = 0;
  while (next_in_script_ < script_.changes.size() && script_.changes[next_in_script_].step <= world_->steps())
    ++next_in_script_;
  begin_record();
}

void LiveWorld::open(World world, Record record) {
  open(std::move(world));
  changes_ = std::move(record.changes);
  first_scene_ = std::move(record.first_scene);
  first_settings_ = std::move(record.first_settings);
  began_ = record.began;
  edited_ = record.edited;
}

void LiveWorld::play_script() {
  for (; next_in_script_ < script_.changes.size() && script_.changes[next_in_script_].step == world_->steps();
       ++next_in_script_)
    apply(script_.changes[next_in_script_]);
}

void LiveWorld::restart(const RunState* rest) {
  if (scripted()) {
    HardCaseSimulation again(script_.scene, script_.options, script_.changes);
    return open(std::move(again.world()), Script(script_));
  }
  branch(world_->steps());
  replace(std::make_unique<World>(Scene(world_->scene()), RunOptions(world_->options()), rest));
  pending_.reset();
  record_restart(changes_);
  if (began_ > 0 && changes_.empty()) changes_.emplace_back();
  collapse();
  history_.clear();
  last_id_map_.clear();
  edited_ = false;
  forget_other_run();
  timeline_.begin(*world_);
  lanes_.begin(world_->steps());
  found_.clear();
}

bool LiveWorld::step(bool measured) {
  const std::int64_t before = world_->steps();
  const std::vector<std::uint32_t> frozen = world_->validation().frozen();
  const Clock::time_point start = Clock::now();
  world_->step();
  const double seconds = seconds_since(start);
  stats_known_ = hash_known_ = false;
  const bool paused = world_->steps() == before;  // by a guard
  const bool freezes = world_->validation().frozen().size() > frozen.size();
  if (before < timeline_.last()) {
    if (!freezes) return !paused && pass_known_state(measured);
    // Guards that were off before can freeze other bodies now.
    if (!paused && timeline_.agrees(*world_)) return pass_known_state(measured);
    branch(before);
  }
  pending_.reset();
  if (freezes) record_frozen(frozen, before);
  if (!paused) timeline_.record_step(*world_, seconds);
  if (freezes) timeline_.record_change(*world_);
  if (paused) return false;
  note_step(measured);
  play_script();
  return true;
}

/// Adds a state, after a step, to the history and the lanes.
void LiveWorld::note_step(bool measured) {
  record_step(*world_, measured ? &stats() : nullptr, history_);
  const HistoryStep& last = history_[history_.size() - 1];
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  const double ms = last.instrumented() ? last.stage_sum() : last.plain_ms;
  lanes_.add(last.step, {measured ? static_cast<float>(last.stats.energy()) : none,
                         measured ? static_cast<float>(last.stats.touching) : none,
                         ms >= 0 ? static_cast<float>(ms) : none});
}

/// Records bodies that guards have frozen. They are frozen in the state before the repeated step.
void LiveWorld::record_frozen(const std::vector<std::uint32_t>& known, std::int64_t step) {
  Change change;
  change.step = step;
  for (const std::uint32_t body : world_->validation().frozen())
    if (!std::ranges::binary_search(known, body)) change.freeze.push_back(body);
  record_change(changes_, std::move(change));
  edited_ = true;
}

const StepStats& LiveWorld::stats() {
  if (stats_known_) return stats_;
  const Clock::time_point start = Clock::now();
  stats_ = world_->measure();
  measure_seconds_ = seconds_since(start);
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
    level_sizes_ = world_->tree().level_sizes();
    level_sizes_step_ = world_->steps();
  }
  return level_sizes_;
}

}  // namespace collidoscope
