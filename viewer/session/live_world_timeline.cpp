// Member functions of LiveWorld that go to earlier states, and keep the run before a branch.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "viewer/session/live_world.h"

namespace collidoscope {
namespace {

/// "restitution, friction", or what a change does to bodies.
std::string change_text(const Change& change) {
  std::vector<std::string> parts;
  change.settings.for_each_set([&](const auto& setting, const auto&) { parts.emplace_back(setting.name); });
  if (!change.add.empty()) parts.push_back(fmt::format("{} added", change.add.size()));
  if (!change.remove.empty()) parts.push_back(fmt::format("{} removed", change.remove.size()));
  if (!change.freeze.empty()) parts.push_back(fmt::format("{} frozen", change.freeze.size()));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

void LiveWorld::go_to(std::int64_t step) { adopt(timeline_.world_at(step, world_->options())); }

/// `world`: at a state of the timeline, without guards. It gets those of the present one, with their limits.
void LiveWorld::adopt(std::unique_ptr<World> world) {
  const std::optional<OnFailure> guards = settings().guards;
  if (const auto& limits = world_->scene().physics.guards) guards_ = *limits;
  replace(std::move(world));
  pending_.reset();
  last_id_map_.clear();
  if (settings().guards != guards) set_guards(guards);
}

/// Before a change at state `now`: keeps the run as another one, and drops the states after it.
void LiveWorld::branch(std::int64_t now) {
  if (now >= timeline_.last()) return;
  if (!scripted()) {
    other_ =
        std::make_unique<OtherRun>(OtherRun{timeline_, lanes_, found_, changes_, history_, edited_, now});
    // Both runs together keep within the budget.
    other_->timeline.set_budget(Timeline::default_budget() / 2);
    timeline_.set_budget(Timeline::default_budget() / 2);
  }
  timeline_.forget_after(now);
  lanes_.forget_after(now);
  std::erase_if(found_, [&](const TimelineMark& mark) { return mark.state > now; });
  history_.forget_after(now);
  std::erase_if(changes_, [&](const Change& change) { return change.step > now; });
  while (next_in_script_ > 0 && script_.changes[next_in_script_ - 1].step > now) --next_in_script_;
}

void LiveWorld::forget_other_run() {
  if (!other_) return;
  other_.reset();
  timeline_.set_budget(Timeline::default_budget());
}

std::optional<WorkspaceView::TimelineView::Other> LiveWorld::other_run() const {
  if (!other_) return std::nullopt;
  return WorkspaceView::TimelineView::Other{other_->fork, other_->timeline.last()};
}

void LiveWorld::open_other_run() {
  OtherRun& other = *other_;
  const std::int64_t state = std::clamp(world_->steps(), other.timeline.first(), other.timeline.last());
  std::unique_ptr<World> world = other.timeline.world_at(state, world_->options());
  std::swap(timeline_, other.timeline);
  std::swap(lanes_, other.lanes);
  std::swap(found_, other.found);
  std::swap(changes_, other.changes);
  std::swap(history_, other.history);
  std::swap(edited_, other.edited);
  adopt(std::move(world));
}

std::vector<TimelineMark> LiveWorld::marks() const {
  std::vector<TimelineMark> marks = found_;
  for (const Change& change : changes_)
    if (change.physical() && change.step >= timeline_.first())
      marks.push_back({TimelineMark::Kind::change, change.step,
                       fmt::format("state {}: {}", change.step, change_text(change))});
  std::ranges::stable_sort(marks, {}, &TimelineMark::state);
  return marks;
}

void LiveWorld::mark(TimelineMark::Kind kind, const std::string& text) {
  const std::int64_t state = world_->steps();
  const auto known = [&](const TimelineMark& mark) { return mark.state == state && mark.text == text; };
  if (std::ranges::none_of(found_, known)) found_.push_back({kind, state, text});
}

void LiveWorld::take_recording(RecordedRun run) {
  const Timeline::Kept& first = *run.timeline.keyframes().front().kept;
  first_scene_ = *first.scene;
  first_settings_ =
      settings_of(first_scene_, world_->options(), std::ssize(first.state.state().bodies.position));
  timeline_ = std::move(run.timeline);
  changes_ = std::move(run.changes);
  began_ = timeline_.first();
  edited_ = !changes_.empty();
  lanes_.begin(began_);
}

/// After a step to a known state. Adds it to the history and the lanes if they have not come so far, as in a
/// run that was read from a file. A state with a change is not compared: guards may have frozen bodies there.
bool LiveWorld::pass_known_state(bool measured) {
  const std::int64_t now = world_->steps();
  if (timeline_.is_change(now))
    go_to(now);
  else
    timeline_.check(*world_);
  if (history_.size() == 0 || history_[history_.size() - 1].step < now) note_step(measured);
  return true;
}

}  // namespace collidoscope
