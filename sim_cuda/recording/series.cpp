#include "sim_cuda/recording/series.h"

#include <limits>
#include <memory>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/out_of_memory.h"

namespace collidoscope {
namespace {

/// `state` with the bodies of a frame. Quantities that the frame does not have are the default.
void place_bodies(const BodyTable& frame, BodyStates& bodies) {
  const std::size_t count = frame.size();
  bodies.position = frame.position;
  const auto take = [&](const auto& values, const auto& usual, auto& all) {
    if (values.empty())
      all.assign(count, usual);
    else
      all = values;
  };
  take(frame.velocity, Vector3d(0, 0, 0), bodies.velocity);
  take(frame.angular_velocity, Vector3d(0, 0, 0), bodies.angular_velocity);
  take(frame.orientation, Quaterniond(1, 0, 0, 0), bodies.orientation);
}

void place_frame(World& world, const RunState& first, const BodyTable& frame, std::size_t k) {
  RunState state = first;
  state.steps = static_cast<std::int64_t>(k);
  state.time = static_cast<double>(k) * world.scene().physics.time_step;
  place_bodies(frame, state.bodies);
  world.restore(state);
}

}  // namespace

void go_to_frame(World& world, const std::vector<BodyTable>& frames, std::size_t k) {
  place_frame(world, world.state(), frames[k], k);
}

RecordedRun run_of_frames(World& world, const std::vector<BodyTable>& frames) {
  return with_allocation_context("preparing the states of a series", [&] {
    const RunState first = world.state();
    const auto scene = std::make_shared<const Scene>(world.scene());
    RecordedRun run{Timeline(std::numeric_limits<std::int64_t>::max()), {}};
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (const Cancellation* asked = world.options().cancellation; asked && asked->requested())
        throw Cancelled();
      place_frame(world, first, frames[k], k);
      Timeline::Kept kept{scene, CompactState(world.state()), world.state_hash()};
      if (k == 0) {
        run.timeline.begin(std::move(kept));
        continue;
      }
      run.timeline.add_hashes(world.hashes());
      run.timeline.add({std::make_shared<const Timeline::Kept>(std::move(kept)), true});
    }
    world.restore(run.timeline.keyframes().front().kept->state.state());
    return run;
  });
}

}  // namespace collidoscope
