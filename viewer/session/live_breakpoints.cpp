#include "viewer/session/live_breakpoints.h"

#include <algorithm>

#include "sim_cuda/core/error.h"
#include "sim_cuda/stability/offending_body.h"

namespace collidoscope {

void LiveBreakpoints::follow(const LiveWorld& live) {
  if (generation_ == live.generation()) return;
  generation_ = live.generation();
  monitor_.reset();
  checkpoint_.clear();
  suppressed_.fill(false);
  stop_.reset();
}

const std::optional<StopView>& LiveBreakpoints::stop(const LiveWorld& live) {
  follow(live);
  return stop_;
}

void LiveBreakpoints::before_step(LiveWorld& live, const BreakConditions& conditions) {
  follow(live);
  if (!conditions.any()) {
    monitor_.reset();
    checkpoint_.clear();
    return;
  }
  if (!monitor_) monitor_.emplace(live.stats());
  checkpoint_.save_if_due(live.world());
}

bool LiveBreakpoints::after_step(LiveWorld& live, const BreakConditions& conditions) {
  World& world = live.world();
  if (world.validation().paused()) {
    const Finding& finding = *world.validation().finding();
    StopView stop;
    stop.what = describe(finding);
    stop.is_violation = true;
    stop.body = finding.body;
    stop.state_before = world.steps();
    stop_at(live, std::move(stop));
    return true;
  }
  if (!monitor_) return false;
  const RunTimes times = world.latest_times();
  BreakConditions asked = conditions;
  for (std::size_t k = 0; k < suppressed_.size(); ++k) {
    if (!suppressed_[k]) continue;
    BreakConditions alone;
    alone.limits[k] = conditions.limits[k];
    suppressed_[k] = alone.any() && monitor_->check(alone, live.stats(), times).has_value();
    asked.limits[k].reset();
  }
  std::optional<BreakpointHit> hit = monitor_->check(asked, live.stats(), times);
  if (!hit) return false;
  hit->body = offending_body(world, hit->condition);
  suppressed_[static_cast<std::size_t>(hit->condition)] = true;
  StopView stop;
  stop.what = describe(*hit);
  stop.body = hit->body;
  stop.state_before = world.steps() - 1;
  cannot_restore_ = generation_ != live.generation();  // the run made a change of its script here
  stop_at(live, std::move(stop));
  return true;
}

void LiveBreakpoints::stop_at(LiveWorld& live, StopView stop) {
  const InitialBodies& initial = live.world().initial();
  const std::vector<std::uint32_t>& frozen = live.world().validation().frozen();
  if (stop.body)
    stop.can_freeze = (initial.motion.empty() || initial.motion[*stop.body] == Motion::dynamic) &&
                      !std::ranges::binary_search(frozen, *stop.body);
  generation_ = live.generation();
  stop_ = std::move(stop);
}

Snapshot LiveBreakpoints::snapshot_before(LiveWorld& live) {
  World& world = live.world();
  if (!stop(live)) throw InputError("the run stands nowhere that a state before would be asked for");
  if (stop_->is_violation) return snapshot_of(world);
  if (cannot_restore_) throw InputError("the run was changed at this very state: there is no way back");
  const std::int64_t now = world.steps();
  checkpoint_.restore(world, stop_->state_before);
  Snapshot snapshot = snapshot_of(world);
  while (world.steps() < now) world.step();
  return snapshot;
}

}  // namespace collidoscope
