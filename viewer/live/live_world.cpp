#include "viewer/live/live_world.h"

#include <fmt/format.h>

#include <chrono>

#include "sim_cuda/run_state.h"
#include "sim_cuda/scene/box_collider.h"

namespace collidoscope {
namespace {

bool same_box(const std::optional<Box>& a, const std::optional<Box>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->min == b->min && a->max == b->max;
}

bool physics_differ(const Settings& a, const Settings& b) {
  return a.time_step != b.time_step || a.restitution != b.restitution || a.precision != b.precision ||
         a.solver != b.solver || a.bodies != b.bodies;
}

}  // namespace

Settings settings_of(const World& world) {
  const Scene& scene = world.scene();
  const RunOptions& options = world.options();
  Settings s;
  s.bodies = static_cast<std::int64_t>(world.initial().size());
  if (scene.generators.size() == 1) {
    const BoxCollider& generator = scene.generators[0];
    s.bodies = generator.count;
    s.radius_max = generator.radius_max;
    s.seed = generator.seed;
    s.variant = generator.variant;
  }
  s.time_step = scene.physics.time_step;
  s.restitution = scene.materials[0].restitution;
  s.precision = scene.physics.precision;
  s.solver = scene.physics.solver;
  s.executor = options.executor;
  s.shape = options.shape;
  s.broad_phase = options.broad_phase;
  return s;
}

void set_scene(const Settings& wish, Scene& scene) {
  if (scene.generators.size() == 1) {
    BoxCollider& generator = scene.generators[0];
    generator.count = wish.bodies;
    generator.radius_max = wish.radius_max;
    generator.seed = wish.seed;
    generator.variant = wish.variant;
    // Joints go with their bodies.
    const std::int64_t bodies = static_cast<std::int64_t>(scene.bodies.size()) + generator.count;
    std::erase_if(scene.joints,
                  [&](const Joint& joint) { return joint.a >= bodies || joint.b.value_or(0) >= bodies; });
  }
  if (wish.time_step != scene.physics.time_step) {
    scene.physics.time_step = wish.time_step;
    scene.physics.steps_per_second.reset();
  }
  scene.materials[0].restitution = wish.restitution;
  scene.physics.precision = wish.precision;
  scene.physics.solver = wish.solver;
}

void set_options(const Settings& wish, RunOptions& options) {
  options.executor = wish.executor;
  options.shape = wish.shape;
  options.broad_phase = wish.broad_phase;
}

void record_step(World& world, const StepStats* measured, History& history) {
  HistoryStep entry;
  entry.step = world.steps();
  // Worlds time even-numbered steps plain and odd-numbered ones stage by stage, counted from 0.
  const bool instrumented = world.steps() % 2 == 0;
  const RunTimes times = world.latest_times();
  if (!instrumented && times.steps_timed > 0) entry.plain_ms = times.step_last_ms;
  if (measured != nullptr) {
    entry.stats = *measured;
    entry.measured = true;
  }
  entry.nodes = world.tree_nodes();
  entry.allocated_bytes = world.allocated_bytes();
  history.add(std::move(entry), instrumented ? times.stages : std::vector<StageTime>{});
}

LiveWorld::LiveWorld(const Scene& scene, const RunOptions& options)
    : world_(std::make_unique<World>(scene, options)) {}

LiveWorld::LiveWorld(World world) : world_(std::make_unique<World>(std::move(world))) {}

void LiveWorld::replace(std::unique_ptr<World> world) {
  world_ = std::move(world);
  ++generation_;
  stats_known_ = hash_known_ = false;
  level_sizes_step_ = -1;
}

std::string LiveWorld::apply(const Settings& wish) {
  Settings now = settings();
  if (wish == now) return "";
  Settings with_shape = now;
  with_shape.shape = wish.shape;
  if (wish == with_shape) {
    world_->set_launch_shape(wish.shape);
    return "";
  }
  const auto start = std::chrono::steady_clock::now();
  Scene scene = world_->scene();
  RunOptions options = world_->options();
  set_scene(wish, scene);
  set_options(wish, options);
  const bool new_box = !same_box(world_->initial().box, box_in_effect(scene));
  const bool new_bodies =
      wish.radius_max != now.radius_max || wish.seed != now.seed || wish.variant != now.variant;
  // Where spheres start apart, or at rest, each place depends on all the others.
  const bool new_places = wish.bodies != now.bodies &&
                          (scene.generators[0].spawn == Spawn::apart || wish.variant == Variant::settled);
  const bool again = new_box || new_bodies || new_places;
  const RunState kept = again ? RunState{} : world_->state();
  auto next = std::make_unique<World>(scene, options, again ? nullptr : &kept);
  std::string said;
  if (again) {
    history_.clear();
    edited_ = false;
    if (new_box && !new_bodies)
      said = fmt::format("restarted: the box of the variant goes with N, {:.4g} m now",
                         next->initial().box->max.x() - next->initial().box->min.x());
    else if (world_->steps() > 0)
      said = "restarted: these are other bodies";
  } else if (physics_differ(wish, now) && world_->steps() > 0) {
    edited_ = true;
  }
  replace(std::move(next));
  change_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return said;
}

void LiveWorld::restart() {
  replace(std::make_unique<World>(Scene(world_->scene()), RunOptions(world_->options())));
  history_.clear();
  edited_ = false;
}

void LiveWorld::step(bool measured) {
  world_->step();
  stats_known_ = hash_known_ = false;
  record_step(*world_, measured ? &stats() : nullptr, history_);
}

const StepStats& LiveWorld::stats() {
  if (!stats_known_) stats_ = world_->measure();
  stats_known_ = true;
  return stats_;
}

std::uint64_t LiveWorld::state_hash() {
  if (!hash_known_) hash_ = world_->state_hash();
  hash_known_ = true;
  return hash_;
}

const std::vector<std::int64_t>& LiveWorld::level_sizes(bool exact) {
  if (level_sizes_step_ < 0 || (exact && level_sizes_step_ != world_->steps())) {
    level_sizes_ = world_->tree_level_sizes();
    level_sizes_step_ = world_->steps();
  }
  return level_sizes_;
}

}  // namespace collidoscope
