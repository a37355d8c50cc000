#include "viewer/session/live_breakpoints.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim_cuda/core/error.h"
#include "sim_cuda/stability/offending_body.h"

namespace collidoscope {
namespace {

/// "Stopped after step 485: penetration 0.103931 m > 0.1 m, body 414".
std::string stop_text(const BreakpointHit& hit) {
  const BreakConditionName& condition = name_of(hit.condition);
  const std::string when = hit.step > 0 ? fmt::format("after step {}", hit.step) : "at state 0",
                    body = hit.body ? fmt::format(", body {}", *hit.body) : "";
  if (!condition.has_limit)
    return fmt::format("Stopped {}: {}, {:.0f} {}{}", when, break_text(hit.condition).label, hit.value,
                       condition.unit, body);
  return fmt::format("Stopped {}: {}{} {:.6g} {} > {:g} {}{}", when, break_text(hit.condition).label,
                     hit.stage.empty() ? "" : " of " + hit.stage, hit.value, condition.unit, hit.limit,
                     condition.unit, body);
}

}  // namespace

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
  stop.what = stop_text(*hit);
  stop.body = hit->body;
  stop.state_before = world.steps() - 1;
  cannot_restore_ = generation_ != live.generation();  // the run applied a change of its script at this state
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
  live.mark(stop.is_violation ? TimelineMark::Kind::violation : TimelineMark::Kind::condition, stop.what);
  stop_ = std::move(stop);
}

Snapshot LiveBreakpoints::snapshot_before(LiveWorld& live) {
  World& world = live.world();
  if (!stop(live)) throw InputError("the run is not stopped at a condition");
  if (stop_->is_violation) return snapshot_of(world);
  if (cannot_restore_)
    throw InputError("the run was changed at this state: the state before it cannot be restored");
  const std::int64_t now = world.steps();
  checkpoint_.restore(world, stop_->state_before);
  Snapshot snapshot = snapshot_of(world);
  while (world.steps() < now) world.step();
  return snapshot;
}

}  // namespace collidoscope
