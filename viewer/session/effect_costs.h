#pragma once
// What each effect of a running scene costs: two worlds are made of the state that it is in, one with the
// effect and one without, and stepped in turns; what counts is the median of the differences. The running
// world is read once, and never touched. Owns the two worlds while it measures, one effect after the other,
// in slices, so that the picture keeps moving.

#include <memory>
#include <vector>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/effect_reasons.h"
#include "sim_cuda/world.h"
#include "ui/effect_view.h"

namespace collidoscope {

class EffectCosts {
 public:
  static constexpr int pairs = 24;  ///< of steps, for each effect

  /// Forgets what was measured, and looks at what `world` calls for.
  void begin(const World& world);
  /// Measures every effect that is on or called for, for about so many milliseconds of each call, at least
  /// one pair of steps, from the state that the world is in at the first; once all are known, nothing more.
  void advance(World& world, double milliseconds);
  bool begun() const { return begun_; }  ///< to measure
  bool done() const { return begun_ && pending_.empty(); }

  /// All effects of the world that begin() was told of, with what is known of their costs.
  std::vector<EffectView> views(const World& world) const;

 private:
  struct Measurement {
    bool Effects::*flag;
    bool on;
    Effects other;  ///< with the switch turned
  };
  void capture_state(World& world);
  bool make_worlds();
  void step_pair();
  void finish();

  std::vector<EffectReason> reasons_;  ///< in the order of effect_names
  bool begun_ = false;
  Scene scene_;  ///< of the state
  RunOptions options_;
  RunState state_;
  Effects now_;
  std::vector<Measurement> pending_;  ///< the last is under way, or next
  std::unique_ptr<World> with_, without_;
  std::vector<float> differences_, without_ms_;  ///< ms
  bool turn_ = false;
  std::vector<std::pair<bool Effects::*, EffectCost>> measured_;
};

}  // namespace collidoscope
