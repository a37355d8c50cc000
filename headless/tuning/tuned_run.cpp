#include "headless/tuning/tuned_run.h"

#include "sim_cuda/core/physics_version.h"

namespace collidoscope {
namespace {

std::optional<StageShape> place_of(const LaunchTuner& tuner) {
  const LaunchShape shape = tuner.reference();
  if (shape.blocks > 0 && shape.threads > 0) return StageShape{"", shape};
  std::optional<StageShape> place;
  double slowest = 0;
  for (const LaunchTuner::Stage& stage : tuner.stages()) {
    if (!stage.obeys || stage.launch.multiprocessors == 0 || stage.reference_ms <= slowest) continue;
    slowest = stage.reference_ms;
    place = {stage.name, {static_cast<int>(stage.launch.blocks), stage.launch.threads}};
  }
  return place;
}

}  // namespace

TunedRun tuned_run(World& world, const LaunchTuner& tuner) {
  const WorldInfo info = world.info();
  return {.scene = world.scene().name,
          .device = info.device_name,
          .executor = info.on_gpu ? "cuda" : "cpu",
          .broad_phase = world.options().broad_phase,
          .bodies = std::ssize(world.initial().radius),
          .state = world.steps(),
          .physics_version = physics_version,
          .reference = tuner.reference(),
          .reference_ms = tuner.reference_ms(),
          .reference_place = place_of(tuner),
          .cell_times = tuner.cell_times()};
}

const char* name_of(LaunchCell::State state) {
  switch (state) {
    case LaunchCell::State::waiting:
      return "not measured";
    case LaunchCell::State::measured:
      return "measured";
    case LaunchCell::State::infeasible:
      return "infeasible";
    case LaunchCell::State::left_out:
      return "left out";
    case LaunchCell::State::wrong:
      return "wrong hash";
  }
  return "";
}

double typical_ms(const TunedRun& run, const LaunchCell& cell) {
  return run.reference_ms * cell.estimate().ratio;
}

}  // namespace collidoscope
