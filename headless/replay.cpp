#include "headless/replay.h"

#include <limits>

namespace collidoscope {

Replay::Replay(const std::string& file, Start& start, RunOptions& options) {
  if (file.empty()) return;
  list_ = read_changes(file, start.scene, options, start.snapshot ? start.snapshot->state.steps : 0);
  for (; next_ < list_.changes.size() && list_.changes[next_].step == 0; ++next_) {
    make_change(list_.changes[next_], start.scene, options);
    start.snapshot.reset();
  }
}

std::int64_t Replay::steps_to_next(const World& world) const {
  if (left() == 0) return std::numeric_limits<std::int64_t>::max();
  return list_.changes[next_].step - world.steps();
}

bool Replay::make_due(World& world) {
  const std::size_t before = next_;
  for (; left() > 0 && list_.changes[next_].step == world.steps(); ++next_)
    if (auto next = changed_world(world, list_.changes[next_], world.options())) world = std::move(*next);
  return next_ != before;
}

}  // namespace collidoscope
