#pragma once
// Measures the cost of each effect of a running scene. Two worlds start from the present state, one with the
// effect and one without, and are stepped in turns. The running world is only read. One effect is measured at
// a time, a time slice per call. Owns the two worlds during a measurement.

#include <memory>
#include <optional>
#include <vector>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/effect_reasons.h"
#include "sim_cuda/tuning/steps_in_turns.h"
#include "sim_cuda/world.h"
#include "ui/effect_view.h"

namespace collidoscope {

class EffectCosts {
 public:
  static constexpr int pairs = 24;  ///< number of pairs of steps per effect

  /// Discards all measurements and determines the effects that `world` needs.
  void begin(const World& world);
  /// Measures each enabled or needed effect, about `milliseconds` per call and at least one pair of steps.
  /// All start from the state at the first call. Does nothing when all are measured.
  void advance(World& world, double milliseconds);
  bool begun() const { return begun_; }  ///< whether measurements were started
  bool done() const { return begun_ && pending_.empty(); }

  /// All effects of the world passed to begin(), with the measured costs.
  std::vector<EffectView> views(const World& world) const;

 private:
  struct Measurement {
    bool Effects::*flag;
    bool on;
    Effects other;  ///< effects with this one switched
  };
  void capture_state(World& world);
  bool make_worlds();
  void step_pair();
  void finish();

  std::vector<EffectReason> reasons_;  ///< ordered as effect_names
  bool begun_ = false;
  Scene scene_;  ///< scene of the initial state
  RunOptions options_;
  RunState state_;
  Effects now_;
  std::vector<Measurement> pending_;  ///< the last one is measured now
  std::unique_ptr<World> with_, without_;
  std::optional<StepsInTurns> turns_;
  std::vector<double> with_ms_, without_ms_;  ///< per step, one entry per pair
  std::vector<std::pair<bool Effects::*, EffectCost>> measured_;
};

}  // namespace collidoscope
