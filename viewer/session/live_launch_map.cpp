#include "viewer/session/live_launch_map.h"

#include <exception>
#include <utility>

#include "sim_cuda/tuning/tuning_text.h"

namespace collidoscope {
void LiveLaunchMap::follow(int generation, LaunchMapRequests& requests) {
  const bool restart = std::exchange(requests.restart, false);
  if (generation == generation_ && !restart) return;
  generation_ = generation;
  tuner_.reset();
  view_ = {};
  requested_ = requests.running = restart;
  taken_ = false;
}

void LiveLaunchMap::advance(World& world, double budget, double milliseconds) {
  if (done()) return;
  try {
    if (!tuner_) {
      view_.start_state = world.steps();
      tuner_ = std::make_unique<LaunchTuner>(world, budget);
      if (hash_) tuner_->set_hash(hash_);
      view_.budget = budget;
      view_.begun = true;
    }
    tuner_->advance(milliseconds);
    view_.done = tuner_->done();
  } catch (const std::exception& error) {  // out of memory
    view_.unavailable_reason = error.what();
    tuner_.reset();
  }
}

const LaunchTuner* LiveLaunchMap::take_complete() {
  if (!tuner_ || !tuner_->done() || std::exchange(taken_, true)) return nullptr;
  return tuner_.get();
}

const LaunchMapView& LiveLaunchMap::view(const World& world) {
  view_.now = world.launch_shape();
  view_.bodies = std::ssize(world.initial().radius);
  if (!tuner_) return view_;
  const LaunchSearch& search = tuner_->search();
  view_.cells = search.cells();
  view_.plateau = search.plateau();
  view_.chosen = search.chosen();
  view_.reference = tuner_->reference();
  view_.reference_ms = tuner_->reference_ms();
  view_.spent = tuner_->spent();
  view_.stages.clear();
  for (LaunchTuner::Stage& stage : tuner_->stages()) {
    if (!stage.obeys) continue;
    LaunchShape shape;
    if (stage.launch.multiprocessors > 0)
      shape = {static_cast<int>(stage.launch.blocks), stage.launch.threads};
    view_.stages.push_back({std::move(stage.name), stage.reference_ms, shape, std::move(stage.cell_ms),
                            std::move(stage.occupancy)});
  }
  if (!view_.done || !view_.chosen) return view_;
  view_.is_faster = search.confirmation().high < 1;
  view_.verdict = verdict_line(search, view_.reference);
  const StageShapes best = tuner_->stage_shapes();
  view_.stage_shapes = stage_shapes_text(best);
  view_.stage_verdict = best.empty() ? ""
                        : tuner_->stage_difference().empty()
                            ? verdict(tuner_->stage_confirmation(), shape_text(view_.reference))
                            : "another result: " + tuner_->stage_difference();
  return view_;
}

}  // namespace collidoscope
