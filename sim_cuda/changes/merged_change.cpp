// A list of changes of state 0 as one change: what a run needs that begins again with all of them.

#include <algorithm>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/scene/body_reader.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

/// What decides the state, as text: a rate and its time step are the same, and guards decide nothing.
std::string scene_text(Scene scene) {
  disable_guards(scene.physics);
  scene.physics.time_step = scene.physics.time_step.seconds();
  return write_scene(scene);
}

/// Both lists are in the order of ids. Adds the ids of those of `before` that `after` lacks; `first` is the
/// id of the first. Returns how many of `after` are left of `before`.
std::size_t find_removed(const std::vector<Body>& before, const std::vector<Body>& after, const Scene& scene,
                         std::int64_t first, std::vector<std::int64_t>& removed) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    if (kept < after.size() && write_body(before[k], scene) == write_body(after[kept], scene))
      ++kept;
    else
      removed.push_back(first + static_cast<std::int64_t>(k));
  }
  return kept;
}

}  // namespace

std::optional<Change> merged_change(const Scene& before, const Scene& after, Change settings) {
  Change change = std::move(settings);
  change.step = 0;
  RunOptions unused;
  Scene now = before;
  apply_change(change, now, unused);
  if (now.generators.size() != after.generators.size()) return std::nullopt;
  if (now.bodies.size() != after.bodies.size())
    find_removed(now.bodies, after.bodies, after, 0, change.remove);
  std::int64_t first = std::ssize(now.bodies);
  for (std::size_t g = 0; g < now.generators.size(); ++g) {
    const std::vector<std::int64_t>& without = now.generators[g].excluded;
    for (const std::int64_t number : after.generators[g].excluded) {
      const auto place = std::ranges::lower_bound(without, number);
      if (place == without.end() || *place != number)
        change.remove.push_back(first + number - (place - without.begin()));
    }
    first += now.generators[g].count - std::ssize(without);
  }
  const std::size_t kept = find_removed(now.extra_bodies, after.extra_bodies, after, first, change.remove);
  change.add.assign(after.extra_bodies.begin() + static_cast<std::ptrdiff_t>(kept), after.extra_bodies.end());
  Scene result = before;
  apply_change(change, result, unused);
  return scene_text(result) == scene_text(after) ? std::optional(std::move(change)) : std::nullopt;
}

}  // namespace collidoscope
