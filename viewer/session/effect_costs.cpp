#include "viewer/session/effect_costs.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <stdexcept>

#include "sim_cuda/core/deadline.h"
#include "sim_cuda/core/stage_clock.h"
#include "sim_cuda/core/statistics.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

/// ms of the next step without stage times, which is every other step. NaN if the step was repeated.
float plain_step(World& world) {
  const int before = world.latest_times().steps_timed;
  world.step(2);
  const RunTimes times = world.latest_times();
  return times.steps_timed > before ? static_cast<float>(times.step_last_ms)
                                    : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace

void EffectCosts::begin(const World& world) {
  *this = {};
  for (const EffectName& effect : effect_names)
    reasons_.push_back(effect_reason(world.scene(), world.initial(), effect.flag));
}

void EffectCosts::capture_state(World& world) {
  begun_ = true;
  scene_ = world.scene();
  options_ = world.options();
  options_.tuned_shapes.clear();  // they may exist for one of two compared runs only
  state_ = world.state();
  now_ = world.effects();
  for (std::size_t k = 0; k < reasons_.size(); ++k) {
    const EffectName& effect = effect_names[k];
    const EffectReason& reason = reasons_[k];
    const bool on = now_.*effect.flag;
    if (on || (reason.required && reason.cannot.empty()))
      pending_.insert(pending_.begin(), {effect.flag, on, with_switched(now_, effect.flag, !on)});
  }
}

bool EffectCosts::make_worlds() {
  const Measurement& measurement = pending_.back();
  EffectCost cost;
  cost.step = state_.steps;
  try {
    Scene other = scene_;
    scene_.physics.effects = now_;
    other.physics.effects = measurement.other;
    for (const Fault& fault : validate(other)) throw std::runtime_error(line_of(fault));
    with_ = std::make_unique<World>(measurement.on ? scene_ : other, options_, &state_);
    without_ = std::make_unique<World>(measurement.on ? other : scene_, options_, &state_);
    cost.bytes = with_->info().allocated_bytes - without_->info().allocated_bytes;
    // Each pair starts with a step without stage times.
    if (state_.steps % 2 == 1) {
      with_->step();
      without_->step();
    }
    plain_step(*with_);  // warm-up
    plain_step(*without_);
  } catch (const std::exception& error) {  // out of memory, or an invalid scene
    with_.reset();
    without_.reset();
    cost.unavailable_reason = error.what();
  }
  measured_.emplace_back(measurement.flag, std::move(cost));
  return with_ != nullptr;
}

void EffectCosts::step_pair() {
  turn_ = !turn_;
  const float first = plain_step(turn_ ? *with_ : *without_), second = plain_step(turn_ ? *without_ : *with_);
  const float with = turn_ ? first : second, without = turn_ ? second : first;
  if (!(with > 0 && without > 0)) return;
  differences_.push_back(with - without);
  without_ms_.push_back(without);
}

void EffectCosts::finish() {
  with_.reset();
  without_.reset();
  differences_.clear();
  without_ms_.clear();
  pending_.pop_back();
  if (pending_.empty()) state_ = {};
}

void EffectCosts::advance(World& world, double milliseconds) {
  if (!begun_) capture_state(world);
  const Deadline slice(milliseconds);
  while (!pending_.empty()) {
    if (with_ == nullptr && !make_worlds()) {
      finish();
      continue;
    }
    EffectCost& cost = measured_.back().second;
    try {
      step_pair();
    } catch (const std::exception& error) {  // out of memory while growing
      cost.unavailable_reason = error.what();
      finish();
      continue;
    }
    cost.pairs = static_cast<int>(differences_.size());
    cost.ms = quantile(differences_, 0.5);
    cost.ms_low = quantile(differences_, 0.25);
    cost.ms_high = quantile(differences_, 0.75);
    cost.without_ms = quantile(without_ms_, 0.5);
    const bool moving = with_->steps() < state_.steps + 10 * pairs && !with_->validation().paused() &&
                        !without_->validation().paused();
    if (cost.pairs >= pairs || !moving) finish();
    if (slice.passed()) break;
  }
}

std::vector<EffectView> EffectCosts::views(const World& world) const {
  std::vector<EffectView> all;
  for (std::size_t k = 0; k < reasons_.size(); ++k) {
    const EffectName& effect = effect_names[k];
    EffectView& view = all.emplace_back();
    view.name = effect.name;
    view.flag = effect.flag;
    view.on = world.effects().*effect.flag;
    view.required = reasons_[k].required;
    view.why = reasons_[k].why;
    view.cannot = reasons_[k].cannot;
    for (const auto& [flag, cost] : measured_)
      if (flag == effect.flag) view.cost = cost;
  }
  return all;
}

}  // namespace collidoscope
