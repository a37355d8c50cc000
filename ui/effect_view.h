#pragma once
// What the panel of effects shows of each: whether it is on, whether the scene calls for it, and what it
// costs. Plain data; whoever runs the scene fills it.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/scene/effects.h"

namespace collidoscope {

/// What a step takes with an effect, less what it takes without, from the same state.
struct EffectCost {
  int pairs = 0;                           ///< of steps, one with and one without; 0: none yet
  double ms = 0, ms_low = 0, ms_high = 0;  ///< median of their differences, and its quartiles
  double without_ms = 0;                   ///< median of the steps without
  std::int64_t bytes = 0;                  ///< in the executor's memory space
  std::int64_t step = 0;                   ///< of the state that it was measured from
  std::string unavailable_reason;          ///< why it cannot be measured, or empty

  /// Whether it is more than the noise: the middle half of the differences lies on one side of 0.
  bool differs_from_zero() const { return pairs >= 4 && (ms_low > 0 || ms_high < 0); }
};

struct EffectView {
  std::string name;
  bool Effects::*flag = nullptr;
  bool on = false, required = false;
  std::string why;                 ///< what calls for it, or why nothing does
  std::string cannot;              ///< why it cannot be on whatever calls for it, or empty
  std::optional<EffectCost> cost;  ///< unset: nobody asked
};

/// Every effect with one switched, and those with it that cannot be without it or that it cannot be without.
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
