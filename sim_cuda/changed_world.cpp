#include "sim_cuda/changes.h"
#include "sim_cuda/run_state.h"

namespace collidoscope {

namespace {

/// Whether the change, which makes `after` of the scene, leads to state 0.
bool begins_anew(const World& world, const Change& change, const Scene& after) {
  return (world.steps() == 0 && change.physical()) || begins_another_run(world.scene(), after);
}

}  // namespace

std::optional<Scene> next_run(const World& world, const Change& change) {
  Scene scene = world.scene();
  RunOptions options = world.options();
  make_change(change, scene, options);
  return begins_anew(world, change, scene) ? std::optional(std::move(scene)) : std::nullopt;
}

std::unique_ptr<World> changed_world(World& world, const Change& change, RunOptions options,
                                     const RunState* rest) {
  if (change.shape_alone() && options.executor == world.options().executor) {
    options.shape.blocks = change.blocks.value_or(options.shape.blocks);
    options.shape.threads = change.threads.value_or(options.shape.threads);
    world.set_launch_shape(options.shape);
    return nullptr;
  }
  Scene scene = world.scene();
  const BodyIds ids = make_change(change, scene, options);
  if (begins_anew(world, change, scene)) return std::make_unique<World>(scene, options, rest);
  const RunState state = world.state();
  return std::make_unique<World>(scene, options, &state, ids);
}

}  // namespace collidoscope
