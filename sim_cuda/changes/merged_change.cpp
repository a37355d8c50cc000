// Merges a list of changes of state 0 into one change, for a restarted run.

#include <algorithm>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/body_reader.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

/// Text of all settings that determine the state: rates as time steps, without guards.
std::string scene_text(Scene scene) {
  disable_guards(scene.physics);
  scene.physics.time_step = scene.physics.time_step.seconds();
  return write_scene(scene);
}

/// Adds the ids of bodies in `before` that are not in `after`. Both lists are in id order; `first` is the
/// id of before[0]. Returns the number of bodies in `after` that are from `before`.
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
  if (now.generators.size() != after.generators.size() || now.body_files.size() != after.body_files.size())
    return std::nullopt;
  if (now.bodies.size() != after.bodies.size())
    find_removed(now.bodies, after.bodies, after, 0, change.remove);
  std::int64_t first = std::ssize(now.bodies);
  const auto find_excluded = [&](const auto& sources, const auto& sources_after) {
    for (std::size_t k = 0; k < sources.size(); ++k) {
      const std::vector<std::int64_t>& without = sources[k].excluded;
      for (const std::int64_t number : sources_after[k].excluded) {
        const auto place = std::ranges::lower_bound(without, number);
        if (place == without.end() || *place != number)
          change.remove.push_back(first + number - (place - without.begin()));
      }
      first += kept_of(sources[k]);
    }
  };
  find_excluded(now.generators, after.generators);
  find_excluded(now.body_files, after.body_files);
  const std::size_t kept = find_removed(now.extra_bodies, after.extra_bodies, after, first, change.remove);
  change.add.assign(after.extra_bodies.begin() + static_cast<std::ptrdiff_t>(kept), after.extra_bodies.end());
  Scene result = before;
  apply_change(change, result, unused);
  return scene_text(result) == scene_text(after) ? std::optional(std::move(change)) : std::nullopt;
}

}  // namespace collidoscope
