#include "viewer/session/live_accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "sim_cuda/core/stage_clock.h"
#include "sim_cuda/core/statistics.h"
#include "viewer/session/live_reference.h"

namespace collidoscope {

void LiveAccuracy::follow(World& world, int generation, AccuracyRequests& requests) {
  const bool requested = std::exchange(requests.restart, false);
  if (generation == generation_ && !requested) return;
  const std::string problem = generation == generation_ ? problem_ : problem_fingerprint(world);
  generation_ = generation;
  if (problem == problem_ && !requested) return;
  problem_ = problem;
  requests.tolerance = 0;
  requests.running = true;
  begin(world);
}

void LiveAccuracy::begin(World& world) {
  study_.reset();
  finished_ = false;
  view_ = {};
  view_.start_state = world.steps();
  if (static_cast<std::int64_t>(world.initial().size()) > max_bodies) {
    view_.unavailable_reason =
        fmt::format("At most {} bodies here; use `collidoscope-headless accuracy` for more.", max_bodies);
    return;
  }
  try {
    const RunState state = world.state();
    AccuracyStudyOptions request;
    request.seconds = seconds;
    request.rounds = rounds;
    study_ = std::make_unique<AccuracyStudy>(world.scene(), world.options(), request, &state);
    view_.seconds = seconds;
    view_.executor = study_->problem().executor;
  } catch (const std::exception& error) {  // nothing moves, or out of memory
    view_.unavailable_reason = error.what();
  }
}

void LiveAccuracy::advance(double milliseconds) {
  if (done()) return;
  try {
    finished_ = !study_->advance(milliseconds);
  } catch (const std::exception& error) {
    view_.unavailable_reason = error.what();
    study_.reset();
  }
}

const AccuracyView& LiveAccuracy::view(const World& world, AccuracyRequests& requests) {
  if (study_) {
    view_.points = study_->points();
    if (study_->reference() != nullptr) view_.reference = *study_->reference();
    view_.warnings = study_->warnings();
    const AccuracyStudy::Progress progress = study_->progress();
    view_.done =
        static_cast<double>(progress.done) / static_cast<double>(std::max<std::int64_t>(progress.total, 1));
    view_.current_task = finished_ ? "" : progress.current_task;
  }
  const Physics& physics = world.scene().physics;
  view_.effects = world.effects();
  view_.now = accuracy_setting(physics, world.substeps(), view_.effects);
  const double reference_error = view_.reference ? view_.reference->error : 0;
  if (!(requests.tolerance > 0)) {  // median error, rounded
    std::vector<float> errors;
    for (const AccuracyPoint& point : view_.points)
      if (point.has_cost() && point.error > reference_error && std::isfinite(point.error))
        errors.push_back(static_cast<float>(point.error));
    if (!errors.empty())
      requests.tolerance = std::pow(10, std::round(std::log10(quantile(errors, 0.5))));
    else if (all_below_reference(view_.points, reference_error) && reference_error > 0)
      requests.tolerance = std::pow(10, std::ceil(std::log10(reference_error)));
  }
  Recommendation answer = recommended(view_.points, reference_error, requests.tolerance);
  view_.cheapest = answer.point;
  view_.no_recommendation_reason = std::move(answer.unavailable_reason);
  return view_;
}

}  // namespace collidoscope
