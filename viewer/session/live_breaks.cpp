#include "viewer/session/live_breaks.h"

#include <algorithm>

#include "sim_cuda/core/error.h"
#include "sim_cuda/stability/culprit.h"

namespace collidoscope {

void LiveBreaks::follow(const LiveWorld& live) {
  if (generation_ == live.generation()) return;
  generation_ = live.generation();
  watch_.reset();
  rewind_.forget();
  passed_over_.fill(false);
  stop_.reset();
}

const std::optional<StopFacts>& LiveBreaks::stop(const LiveWorld& live) {
  follow(live);
  return stop_;
}

void LiveBreaks::before_step(LiveWorld& live, const BreakConditions& conditions) {
  follow(live);
  if (!conditions.any()) {
    watch_.reset();
    rewind_.forget();
    return;
  }
  if (!watch_) watch_.emplace(live.stats());
  rewind_.before_step(live.world());
}

bool LiveBreaks::after_step(LiveWorld& live, const BreakConditions& conditions) {
  World& world = live.world();
  if (world.guards().paused()) {
    const Finding& finding = *world.guards().finding();
    StopFacts stop;
    stop.what = describe(finding);
    stop.found = true;
    stop.body = finding.body;
    stop.before = world.steps();
    stop_at(live, std::move(stop));
    return true;
  }
  if (!watch_) return false;
  const RunTimes times = world.latest_times();
  BreakConditions asked = conditions;
  for (std::size_t k = 0; k < passed_over_.size(); ++k) {
    if (!passed_over_[k]) continue;
    BreakConditions alone;
    alone.limits[k] = conditions.limits[k];
    passed_over_[k] = alone.any() && watch_->look(alone, live.stats(), times).has_value();
    asked.limits[k].reset();
  }
  std::optional<Broken> broken = watch_->look(asked, live.stats(), times);
  if (!broken) return false;
  broken->body = culprit(world, broken->condition);
  passed_over_[static_cast<std::size_t>(broken->condition)] = true;
  StopFacts stop;
  stop.what = describe(*broken);
  stop.body = broken->body;
  stop.before = world.steps() - 1;
  no_way_back_ = generation_ != live.generation();  // the run made a change of its script here
  stop_at(live, std::move(stop));
  return true;
}

void LiveBreaks::stop_at(LiveWorld& live, StopFacts stop) {
  const InitialBodies& initial = live.world().initial();
  const std::vector<std::uint32_t>& frozen = live.world().guards().frozen();
  if (stop.body)
    stop.can_freeze = (initial.motion.empty() || initial.motion[*stop.body] == Motion::dynamic) &&
                      !std::ranges::binary_search(frozen, *stop.body);
  generation_ = live.generation();
  stop_ = std::move(stop);
}

Snapshot LiveBreaks::before(LiveWorld& live) {
  World& world = live.world();
  if (!stop(live)) throw InputError("the run stands nowhere that a state before would be asked for");
  if (stop_->found) return snapshot_of(world);
  if (no_way_back_) throw InputError("the run was changed at this very state: there is no way back");
  const std::int64_t now = world.steps();
  rewind_.to(world, stop_->before);
  Snapshot snapshot = snapshot_of(world);
  while (world.steps() < now) world.step();
  return snapshot;
}

}  // namespace collidoscope
