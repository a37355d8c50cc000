#include "sim_cuda/tuning/paired_steps.h"

#include <fmt/format.h>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/wall_clock.h"
#include "sim_cuda/tuning/steps_in_turns.h"

namespace collidoscope {
namespace {

/// Earlier results have no effect: `auto` is what tune compares with.
std::unique_ptr<World> marked_world(const Scene& scene, RunOptions options, const RunState& state) {
  options.tuned_shapes.clear();
  auto world = std::make_unique<World>(scene, options, &state);
  world->mark();
  return world;
}

}  // namespace

PairedSteps::PairedSteps(World& world)
    : state_(world.state()),
      reference_(marked_world(world.scene(), world.options(), state_)),
      candidate_(marked_world(world.scene(), world.options(), state_)),
      hash_([](World& one) { return one.state_hash(); }) {}

void PairedSteps::replace_candidate(const Scene& scene, const RunOptions& options) {
  candidate_.reset();
  candidate_ = marked_world(scene, options, state_);
}

PairedSteps::Durations PairedSteps::measure(int pairs, Clock::time_point end,
                                            const std::function<void(double, double)>& note) {
  // The first steps after a change record graphs and fill caches.
  for (World* world : {candidate_.get(), reference_.get()}) {
    if (!world->rewind()) {
      world->restore(state_);
      world->mark();
    }
    world->step(steps_of_pair);
  }
  const Clock::time_point start = Clock::now();
  StepsInTurns turns({reference_.get(), candidate_.get()}, steps_of_pair);
  for (int pair = 0; pair < pairs && (pair == 0 || Clock::now() < end); ++pair) {
    // A GPU looks at a request only in steps that take longer than 5 ms.
    if (Cancellation* const cancellation = reference_->options().cancellation;
        cancellation != nullptr && cancellation->poll())
      throw Cancelled();
    const std::vector<double> ms = turns.turn();
    note(ms[1], ms[0]);
  }
  return {1e3 * seconds_since(start), 0};
}

std::string PairedSteps::difference(Durations& durations) {
  const Clock::time_point start = Clock::now();
  const std::uint64_t expected = hash_(*reference_), actual = hash_(*candidate_);
  durations.check = 1e3 * seconds_since(start);
  if (actual == expected) return "";
  return fmt::format("state {}: hash {:016x}, expected {:016x}", candidate_->steps(), actual, expected);
}

}  // namespace collidoscope
