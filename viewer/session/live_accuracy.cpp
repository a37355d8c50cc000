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

void LiveAccuracy::follow(World& world, int generation, AccuracyWishes& wishes) {
  const bool wished = std::exchange(wishes.restart, false);
  if (generation == generation_ && !wished) return;
  const std::string problem = generation == generation_ ? problem_ : problem_of(world);
  generation_ = generation;
  if (problem == problem_ && !wished) return;
  problem_ = problem;
  wishes.tolerance = 0;
  wishes.running = true;
  begin(world);
}

void LiveAccuracy::begin(World& world) {
  study_.reset();
  finished_ = false;
  facts_ = {};
  facts_.since = world.steps();
  if (static_cast<std::int64_t>(world.initial().size()) > most_bodies) {
    facts_.lack = fmt::format("Here with at most {} bodies; `collidoscope-headless accuracy` takes its time.",
                              most_bodies);
    return;
  }
  try {
    const RunState state = world.state();
    AccuracyRequest request;
    request.seconds = seconds;
    request.rounds = rounds;
    study_ = std::make_unique<AccuracyStudy>(world.scene(), world.options(), request, &state);
    facts_.seconds = seconds;
    facts_.executor = study_->subject().executor;
  } catch (const std::exception& error) {  // nothing moves, or no memory
    facts_.lack = error.what();
  }
}

void LiveAccuracy::go_on(double milliseconds) {
  if (done()) return;
  try {
    finished_ = !study_->advance(milliseconds);
  } catch (const std::exception& error) {
    facts_.lack = error.what();
    study_.reset();
  }
}

const AccuracyFacts& LiveAccuracy::facts(const World& world, AccuracyWishes& wishes) {
  if (study_) {
    facts_.points = study_->points();
    if (study_->reference() != nullptr) facts_.reference = *study_->reference();
    facts_.doubts = study_->doubts();
    const AccuracyStudy::Progress progress = study_->progress();
    facts_.done =
        static_cast<double>(progress.done) / static_cast<double>(std::max<std::int64_t>(progress.total, 1));
    facts_.doing = finished_ ? "" : progress.doing;
  }
  const Physics& physics = world.scene().physics;
  facts_.effects = world.effects();
  facts_.now = accuracy_setting(physics, world.substeps(), facts_.effects);
  const double reference_error = facts_.reference ? facts_.reference->error : 0;
  if (!(wishes.tolerance > 0)) {  // the middle of what there is, as a round number
    std::vector<float> errors;
    for (const AccuracyPoint& point : facts_.points)
      if (point.has_price() && point.error > reference_error && std::isfinite(point.error))
        errors.push_back(static_cast<float>(point.error));
    if (!errors.empty())
      wishes.tolerance = std::pow(10, std::round(std::log10(quantile(errors, 0.5))));
    else if (all_below_reference(facts_.points, reference_error) && reference_error > 0)
      wishes.tolerance = std::pow(10, std::ceil(std::log10(reference_error)));
  }
  Recommendation answer = recommended(facts_.points, reference_error, wishes.tolerance);
  facts_.cheapest = answer.point;
  facts_.no_choice = std::move(answer.lack);
  return facts_;
}

}  // namespace collidoscope
