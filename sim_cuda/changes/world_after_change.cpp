#include <algorithm>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/run/frozen.h"

namespace collidoscope {
namespace {

/// True if the change, which turns `before` into `after`, restarts the run at state 0.
bool leads_to_restart(std::int64_t steps, const Scene& before, const Change& change, const Scene& after) {
  return (steps == 0 && change.physical()) || requires_restart(before, after);
}

bool is_frozen(const RunState& state, std::uint32_t body) {
  return std::ranges::binary_search(state.frozen, body);
}

/// Freezes bodies at state 0: those frozen so far, and those of the change.
void freeze_at_start(World& world, const SavedRun& run, const Change& change, const BodyIdMap& ids) {
  std::vector<std::uint32_t> frozen = run.state.frozen;
  for (const std::int64_t body : change.freeze) frozen.push_back(static_cast<std::uint32_t>(body));
  if (frozen.empty()) return;
  RunState state = world.state();
  for (const std::uint32_t body : frozen) {
    const std::uint32_t now = ids.empty() ? body : ids.at(body);
    if (now != no_body && now < world.initial().size()) state.frozen.push_back(now);
  }
  std::ranges::sort(state.frozen);
  state.frozen.erase(std::unique(state.frozen.begin(), state.frozen.end()), state.frozen.end());
  world.restore(state);
}

}  // namespace

SavedRun save_run(World& world) { return {world.scene(), world.options(), world.state()}; }

std::optional<Scene> scene_after_restart(const World& world, const Change& change) {
  Scene scene = world.scene();
  RunOptions options = world.options();
  apply_change(change, scene, options);
  return leads_to_restart(world.steps(), world.scene(), change, scene) ? std::optional(std::move(scene))
                                                                       : std::nullopt;
}

std::unique_ptr<World> world_after_change(World& world, const Change& change, RunOptions options,
                                          const RunState* rest) {
  if (change.only_launch_shape() && options.executor == world.options().executor) {
    LaunchShape& shape = options.shape;
    shape.blocks = change.settings.get<&LaunchShape::blocks>().value_or(shape.blocks);
    shape.threads = change.settings.get<&LaunchShape::threads>().value_or(shape.threads);
    world.set_launch_shape(options.shape);
    return nullptr;
  }
  return world_after_change(save_run(world), change, std::move(options), rest);
}

std::unique_ptr<World> world_after_change(const SavedRun& run, const Change& change, RunOptions options,
                                          const RunState* rest) {
  Scene scene = run.scene;
  const BodyIdMap ids = apply_change(change, scene, options);
  if (leads_to_restart(run.state.steps, run.scene, change, scene)) {
    auto world = std::make_unique<World>(scene, options, rest);
    if (!requires_restart(run.scene, scene)) freeze_at_start(*world, run, change, ids);
    return world;
  }
  if (change.freeze.empty()) return std::make_unique<World>(scene, options, &run.state, ids);
  RunState state = run.state;
  const InitialBodies initial = initial_bodies(run.scene);
  for (const std::int64_t id : change.freeze)
    if (const auto body = static_cast<std::uint32_t>(id); !is_frozen(state, body))
      freeze(state, body, initial, run.scene.physics.guards.value_or(ValidationSettings{}));
  return std::make_unique<World>(scene, options, &state, ids);
}

}  // namespace collidoscope
