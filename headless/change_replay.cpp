#include "headless/replay.h"

#include <limits>

namespace collidoscope {

Replay::Replay(const std::string& file, Start& start, RunOptions& options) {
  if (file.empty()) return;
  list_ = read_changes(file, start.scene, options, start.snapshot ? start.snapshot->state.steps : 0);
  const std::vector<Change>& changes = list_.changes;
  if (!changes.empty() && changes[0].step == 0) start.snapshot.reset();
  // Freezing bodies needs a world, which does not exist yet. make_due() applies the remaining changes.
  for (; next_ < changes.size() && changes[next_].step == 0 && changes[next_].freeze.empty(); ++next_)
    apply_change(changes[next_], start.scene, options);
}

std::int64_t Replay::steps_to_next(const World& world) const {
  if (left() == 0) return std::numeric_limits<std::int64_t>::max();
  return list_.changes[next_].step - world.steps();
}

bool Replay::make_due(World& world) {
  const std::size_t before = next_;
  for (; left() > 0 && list_.changes[next_].step == world.steps(); ++next_)
    if (auto next = world_after_change(world, list_.changes[next_], world.options()))
      world = std::move(*next);
  return next_ != before;
}

}  // namespace collidoscope
