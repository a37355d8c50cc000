#include "viewer/session/live_launch_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <exception>
#include <utility>

namespace collidoscope {
namespace {

std::string name_of(LaunchShape shape) {
  const auto part = [](int value) { return value == 0 ? "auto" : std::to_string(value); };
  if (shape == LaunchShape{}) return "auto";
  return "B = " + part(shape.blocks) + ", T = " + part(shape.threads);
}

}  // namespace

void LiveLaunchMap::follow(int generation, LaunchMapRequests& requests) {
  const bool restart = std::exchange(requests.restart, false);
  if (generation == generation_ && !restart) return;
  generation_ = generation;
  tuner_.reset();
  view_ = {};
  requested_ = requests.running = restart;
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
  for (LaunchTuner::Stage& stage : tuner_->stages())
    if (stage.obeys)
      view_.stages.push_back({std::move(stage.name), stage.reference_ms, stage.reference_shape,
                              std::move(stage.cell_ms), std::move(stage.occupancy)});
  if (!view_.done || !view_.chosen) return view_;
  const RatioEstimate confirmed = search.confirmation();
  const std::string reference = name_of(view_.reference);
  view_.is_faster = confirmed.high < 1;
  view_.verdict = fmt::format("{}: {}{}", name_of(view_.cells[*view_.chosen].shape),
                              verdict(confirmed, reference), view_.is_faster ? "" : ". Keep " + reference);
  std::vector<std::string> parts;
  for (const auto& [stage, shape] : tuner_->stage_shapes())
    parts.push_back(fmt::format("{}={}x{}", stage, shape.blocks, shape.threads));
  view_.stage_shapes = fmt::format("{}", fmt::join(parts, ","));
  view_.stage_verdict = parts.empty() ? ""
                        : tuner_->stage_difference().empty()
                            ? verdict(tuner_->stage_confirmation(), reference)
                            : "another result: " + tuner_->stage_difference();
  return view_;
}

}  // namespace collidoscope
