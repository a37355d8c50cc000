#include "sim_cuda/changes/changes.h"

#include <algorithm>

#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/box_collider.h"

namespace collidoscope {
namespace {

/// Index, in its source, of the `place`-th body that exists.
std::int64_t index_of(const std::vector<std::int64_t>& excluded, std::int64_t place) {
  std::int64_t index = place;
  for (const std::int64_t left_out : excluded) {
    if (left_out > index) break;
    ++index;
  }
  return index;
}

/// Removes body `id` of a list of sources. Subtracts the bodies of the earlier ones from `id`. Returns
/// whether the list has the body.
template <class Source>
bool exclude_body(std::vector<Source>& sources, std::int64_t& id) {
  for (Source& source : sources) {
    const std::int64_t made = kept_of(source);
    if (id < made) {
      const std::int64_t index = index_of(source.excluded, id);
      source.excluded.insert(std::ranges::upper_bound(source.excluded, index), index);
      return true;
    }
    id -= made;
  }
  return false;
}

/// Removes a body; higher ids move down. Precondition: the id exists.
void remove_body(Scene& scene, std::int64_t id) {
  const auto erase = [&](std::vector<Body>& list) { list.erase(list.begin() + id); };
  if (id < std::ssize(scene.bodies)) return erase(scene.bodies);
  id -= std::ssize(scene.bodies);
  if (exclude_body(scene.generators, id) || exclude_body(scene.body_files, id)) return;
  erase(scene.extra_bodies);
}

/// Sets N of the only generator and updates `ids`. Added bodies come last.
void set_count(Scene& scene, std::int64_t count, BodyIdMap& ids) {
  BoxCollider& generator = scene.generators.at(0);
  const auto first = static_cast<std::size_t>(std::ssize(scene.bodies));
  const auto before = static_cast<std::size_t>(kept_of(generator));
  generator.count = count;
  std::erase_if(generator.excluded, [&](std::int64_t number) { return number >= count; });
  const auto after = static_cast<std::size_t>(kept_of(generator));
  for (std::size_t body = first + std::min(before, after); body < ids.size(); ++body)
    ids[body] = body < first + before ? no_body : static_cast<std::uint32_t>(body - before + after);
}

void remove_bodies(Scene& scene, std::vector<std::int64_t> gone, BodyIdMap& ids) {
  std::ranges::sort(gone);
  for (auto id = gone.rbegin(); id != gone.rend(); ++id) remove_body(scene, *id);
  for (std::uint32_t& id : ids) {
    if (id == no_body) continue;
    const auto below = std::ranges::lower_bound(gone, static_cast<std::int64_t>(id));
    if (below != gone.end() && *below == id)
      id = no_body;
    else
      id -= static_cast<std::uint32_t>(below - gone.begin());
  }
}

/// Updates the bodies of joints; removes joints of removed bodies.
void remap_joints(Scene& scene, const BodyIdMap& ids) {
  const auto gone = [&](std::int64_t& id) {
    const std::uint32_t now = ids.at(static_cast<std::size_t>(id));
    id = now;
    return now == no_body;
  };
  std::erase_if(scene.joints, [&](Joint& joint) { return gone(joint.a) || (joint.b && gone(*joint.b)); });
}

bool same_box(const std::optional<Box>& a, const std::optional<Box>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->min == b->min && a->max == b->max;
}

}  // namespace

bool Change::physical() const {
  return settings.physical() || !remove.empty() || !add.empty() || !freeze.empty();
}

bool Change::only_launch_shape() const {
  return !physical() && !settings.empty() &&
         !settings.any([](const auto& setting) { return setting.live != Live::in_place; });
}

BodyIdMap apply_change(const Change& change, Scene& scene, RunOptions& options) {
  BodyIdMap ids;
  const auto& count = change.settings.get<&BoxCollider::count>();
  if (count || !change.remove.empty()) {
    ids.resize(static_cast<std::size_t>(bodies_of(scene)));
    for (std::size_t body = 0; body < ids.size(); ++body) ids[body] = static_cast<std::uint32_t>(body);
  }
  if (count) set_count(scene, *count, ids);
  apply(change.settings, scene, options);
  remove_bodies(scene, change.remove, ids);
  if (!ids.empty()) remap_joints(scene, ids);
  scene.extra_bodies.insert(scene.extra_bodies.end(), change.add.begin(), change.add.end());
  return ids;
}

bool requires_restart(const Scene& before, const Scene& after) {
  if (!same_box(box_in_effect(before), box_in_effect(after))) return true;
  for (std::size_t g = 0; g < std::min(before.generators.size(), after.generators.size()); ++g) {
    const BoxCollider &a = before.generators[g], &b = after.generators[g];
    bool other_bodies = false;
    for_each_field(generator_settings, [&](const auto& setting) {
      if (setting.live == Live::restart && a.*setting.member != b.*setting.member) other_bodies = true;
    });
    if (other_bodies) return true;
    // With this spawn or variant, each position depends on all others.
    if (a.count != b.count && (a.spawn == Spawn::apart || a.variant == Variant::settled)) return true;
  }
  return before.body_files.size() != after.body_files.size() ||
         !std::equal(before.body_files.begin(), before.body_files.end(), after.body_files.begin(),
                     [](const BodyFile& a, const BodyFile& b) { return a.table == b.table; });
}

void record_change(std::vector<Change>& changes, Change change, bool extends_last) {
  const bool replaces = !changes.empty() && (extends_last || changes.back().step == change.step) &&
                        !changes.back().physical() && !change.physical();
  if (!replaces) {
    changes.push_back(std::move(change));
    return;
  }
  Change& last = changes.back();
  last.step = change.step;
  last.settings.merge(change.settings);
}

void record_restart(std::vector<Change>& changes) {
  for (Change& change : changes) {
    change.step = 0;
    change.freeze.clear();
  }
  std::erase_if(changes, [](const Change& change) { return !change.physical() && change.settings.empty(); });
}

}  // namespace collidoscope
