#include "headless/change_replay.h"

#include <limits>

namespace collidoscope {

ChangeReplay::ChangeReplay(const std::string& file, Start& start, RunOptions& options) {
  if (file.empty()) return;
  list_ = read_changes(file, start.scene, options, start.snapshot ? start.snapshot->state.steps : 0);
  const std::vector<Change>& changes = list_.changes;
  if (!changes.empty() && changes[0].step == 0) start.snapshot.reset();
  // Freezing bodies needs a world, which does not exist yet. make_due() applies the remaining changes.
  for (; next_ < changes.size() && changes[next_].step == 0 && changes[next_].freeze.empty(); ++next_)
    apply_change(changes[next_], start.scene, options);
}

std::int64_t ChangeReplay::steps_to_next(const World& world) const {
  if (left() == 0) return std::numeric_limits<std::int64_t>::max();
  return list_.changes[next_].step - world.steps();
}

bool ChangeReplay::make_due(World& world, Recorder* recorder) {
  const std::size_t before = next_;
  for (; left() > 0 && list_.changes[next_].step == world.steps(); ++next_) {
    const Change& change = list_.changes[next_];
    const Scene scene_before = recorder != nullptr ? world.scene() : Scene{};
    if (auto next = world_after_change(world, change, world.options())) world = std::move(*next);
    if (recorder != nullptr) recorder->record_change(world, change, scene_before);
  }
  return next_ != before;
}

}  // namespace collidoscope
