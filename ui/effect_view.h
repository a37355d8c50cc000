#pragma once
// Data of the effects panel: for each effect whether it is on, whether the scene needs it, and its cost.
// Plain structs, written by the caller.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/core/ratio_estimate.h"
#include "sim_cuda/scene/effects.h"

namespace collidoscope {

/// Step times with and without an effect, from the same state, measured in turns.
struct EffectCost {
  RatioEstimate ratio;             ///< time with the effect over time without it; no pairs: not yet measured
  double without_ms = 0;           ///< median step time without the effect
  std::int64_t bytes = 0;          ///< difference in the executor's memory
  std::int64_t step = 0;           ///< state at which the measurement started
  std::string unavailable_reason;  ///< why it cannot be measured; empty: measured

  /// What the effect adds to a step. Infinite bounds until there are enough pairs.
  double ms() const { return (ratio.ratio - 1) * without_ms; }
  double ms_low() const { return (ratio.low - 1) * without_ms; }
  double ms_high() const { return (ratio.high - 1) * without_ms; }
};

struct EffectView {
  std::string name;
  bool Effects::*flag = nullptr;
  bool on = false, required = false;
  std::string why;                 ///< why the scene needs it or does not need it
  std::string cannot;              ///< why it cannot be switched on; empty: it can
  std::optional<EffectCost> cost;  ///< unset: not requested
};

/// Effects after switching one of them, including its prerequisites or dependents.
inline Effects with_switched(Effects effects, bool Effects::*flag, bool on) {
  effects.*flag = on;
  if (on) {
    effects.friction |= effects.rolling_resistance;
    effects.rotation |= effects.friction;
  } else {
    effects.friction &= effects.rotation;
    effects.rolling_resistance &= effects.friction;
  }
  return effects;
}

}  // namespace collidoscope
