#pragma once
// Data of the effects panel: for each effect whether it is on, whether the scene needs it, and its cost.
// Plain structs, written by the caller.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/scene/effects.h"

namespace collidoscope {

/// Step time with an effect minus step time without it, from the same state.
struct EffectCost {
  int pairs = 0;                           ///< number of pairs of steps, with and without; 0: none yet
  double ms = 0, ms_low = 0, ms_high = 0;  ///< median and quartiles of the differences
  double without_ms = 0;                   ///< median step time without the effect
  std::int64_t bytes = 0;                  ///< difference in the executor's memory
  std::int64_t step = 0;                   ///< state at which the measurement started
  std::string unavailable_reason;          ///< why it cannot be measured; empty: measured

  /// Whether the cost is significant: both quartiles of the differences have the same sign.
  bool differs_from_zero() const { return pairs >= 4 && (ms_low > 0 || ms_high < 0); }
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
