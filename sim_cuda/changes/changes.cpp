#include "sim_cuda/changes/changes.h"

#include <algorithm>

#include "sim_cuda/scene/box_collider.h"

namespace collidoscope {
namespace {

std::int64_t generated_count(const BoxCollider& generator) {
  return generator.count - static_cast<std::int64_t>(generator.without.size());
}

/// Of the body that is the `place`-th that the generator makes.
std::int64_t generated_number(const BoxCollider& generator, std::int64_t place) {
  std::int64_t number = place;
  for (const std::int64_t left_out : generator.without) {
    if (left_out > number) break;
    ++number;
  }
  return number;
}

/// Without the body of this id, which the scene has; ids above it move down.
void remove_body(Scene& scene, std::int64_t id) {
  const auto erase = [&](std::vector<Body>& list) { list.erase(list.begin() + id); };
  if (id < std::ssize(scene.bodies)) return erase(scene.bodies);
  id -= std::ssize(scene.bodies);
  for (BoxCollider& generator : scene.generators) {
    const std::int64_t made = generated_count(generator);
    if (id < made) {
      const std::int64_t number = generated_number(generator, id);
      generator.without.insert(std::ranges::upper_bound(generator.without, number), number);
      return;
    }
    id -= made;
  }
  erase(scene.added);
}

/// N of the only generator, and what becomes of the bodies: those that were added come last.
void set_count(Scene& scene, std::int64_t count, BodyIdMap& ids) {
  BoxCollider& generator = scene.generators.at(0);
  const auto first = static_cast<std::size_t>(std::ssize(scene.bodies));
  const auto before = static_cast<std::size_t>(generated_count(generator));
  generator.count = count;
  std::erase_if(generator.without, [&](std::int64_t number) { return number >= count; });
  const auto after = static_cast<std::size_t>(generated_count(generator));
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

/// Joints go with their bodies.
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

template <class Value>
void set_if_given(Value& value, const std::optional<Value>& request) {
  if (request) value = *request;
}

}  // namespace

bool Change::physical() const {
  return bodies || radius_max || seed || variant || time_step || steps_per_second || substeps || iterations ||
         restitution || solver || integrator || rotation_update || precision || effects || !remove.empty() ||
         !add.empty() || !freeze.empty();
}

bool Change::only_launch_shape() const { return !physical() && !broad_phase && (blocks || threads); }

std::int64_t bodies_of(const Scene& scene) {
  std::int64_t count = std::ssize(scene.bodies) + std::ssize(scene.added);
  for (const BoxCollider& generator : scene.generators) count += generated_count(generator);
  return count;
}

BodyIdMap apply_change(const Change& change, Scene& scene, RunOptions& options) {
  BodyIdMap ids;
  if (change.bodies || !change.remove.empty()) {
    ids.resize(static_cast<std::size_t>(bodies_of(scene)));
    for (std::size_t body = 0; body < ids.size(); ++body) ids[body] = static_cast<std::uint32_t>(body);
  }
  if (change.bodies) set_count(scene, *change.bodies, ids);
  if (change.radius_max || change.seed || change.variant) {
    BoxCollider& generator = scene.generators.at(0);
    set_if_given(generator.radius_max, change.radius_max);
    set_if_given(generator.seed, change.seed);
    set_if_given(generator.variant, change.variant);
  }
  Physics& physics = scene.physics;
  if (change.time_step) {
    physics.time_step = *change.time_step;
    physics.steps_per_second.reset();
  }
  if (change.steps_per_second) {
    physics.steps_per_second = change.steps_per_second;
    physics.time_step = 1.0 / *change.steps_per_second;
  }
  set_if_given(physics.substeps, change.substeps);
  set_if_given(physics.iterations, change.iterations);
  set_if_given(scene.materials.at(0).restitution, change.restitution);
  set_if_given(physics.solver, change.solver);
  set_if_given(physics.integrator, change.integrator);
  set_if_given(physics.rotation_update, change.rotation_update);
  set_if_given(physics.precision, change.precision);
  set_if_given(physics.effects, change.effects);
  remove_bodies(scene, change.remove, ids);
  if (!ids.empty()) remap_joints(scene, ids);
  scene.added.insert(scene.added.end(), change.add.begin(), change.add.end());

  set_if_given(options.shape.blocks, change.blocks);
  set_if_given(options.shape.threads, change.threads);
  set_if_given(options.broad_phase, change.broad_phase);
  return ids;
}

bool requires_restart(const Scene& before, const Scene& after) {
  if (!same_box(box_in_effect(before), box_in_effect(after))) return true;
  for (std::size_t g = 0; g < std::min(before.generators.size(), after.generators.size()); ++g) {
    const BoxCollider &a = before.generators[g], &b = after.generators[g];
    if (a.radius_max != b.radius_max || a.seed != b.seed || a.variant != b.variant || a.spawn != b.spawn)
      return true;
    // Where spheres start apart, or at rest, each place depends on all the others.
    if (a.count != b.count && (a.spawn == Spawn::apart || a.variant == Variant::settled)) return true;
  }
  return false;
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
  if (change.blocks) last.blocks = change.blocks;
  if (change.threads) last.threads = change.threads;
  if (change.broad_phase) last.broad_phase = change.broad_phase;
}

void record_restart(std::vector<Change>& changes) {
  for (Change& change : changes) {
    change.step = 0;
    change.freeze.clear();
  }
  std::erase_if(changes, [](const Change& change) {
    return !change.physical() && !change.broad_phase && !change.blocks && !change.threads;
  });
}

}  // namespace collidoscope
