#include "viewer/session/effect_costs.h"

#include <algorithm>
#include <exception>
#include <stdexcept>

#include "sim_cuda/core/deadline.h"
#include "sim_cuda/core/statistics.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

constexpr int steps_of_turn = 2;

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
    turns_.emplace(std::vector<World*>{without_.get(), with_.get()}, steps_of_turn);
    turns_->turn();                        // warm-up
  } catch (const std::exception& error) {  // out of memory, or an invalid scene
    with_.reset();
    without_.reset();
    cost.unavailable_reason = error.what();
  }
  measured_.emplace_back(measurement.flag, std::move(cost));
  return with_ != nullptr;
}

void EffectCosts::step_pair() {
  const std::vector<double> ms = turns_->turn();
  without_ms_.push_back(ms[0]);
  with_ms_.push_back(ms[1]);
}

void EffectCosts::finish() {
  with_.reset();
  without_.reset();
  turns_.reset();
  with_ms_.clear();
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
    cost.ratio = estimate_ratio(ratios_of(with_ms_, without_ms_));
    cost.without_ms = quantile(without_ms_, 0.5);
    const bool stopped = with_->validation().paused() || without_->validation().paused();
    if (cost.ratio.pairs >= pairs || stopped) finish();
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
