#include "sim_cuda/changes.h"
#include "sim_cuda/run_state.h"

namespace collidoscope {

std::unique_ptr<World> changed_world(World& world, const Change& change, RunOptions options) {
  if (change.shape_alone() && options.executor == world.options().executor) {
    options.shape.blocks = change.blocks.value_or(options.shape.blocks);
    options.shape.threads = change.threads.value_or(options.shape.threads);
    world.set_launch_shape(options.shape);
    return nullptr;
  }
  Scene scene = world.scene();
  const BodyIds ids = make_change(change, scene, options);
  if ((world.steps() == 0 && change.physical()) || begins_another_run(world.scene(), scene))
    return std::make_unique<World>(scene, options);
  const RunState state = world.state();
  return std::make_unique<World>(scene, options, &state, ids);
}

}  // namespace collidoscope
