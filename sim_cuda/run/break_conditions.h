#pragma once
// Where a run is to stop for somebody to look: conditions on what is measured of a state, and of the step
// that led to it. Plain data and functions over plain data; who asks measures each state, which costs about
// as much as finding its contacts once more.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/measure/step_stats.h"

namespace collidoscope {

enum class BreakCondition { non_finite, energy_rise, penetration, speed, stage_ms, escaped };

struct BreakConditionName {
  BreakCondition condition;
  std::string_view name;     ///< as --break has it
  std::string_view unit;     ///< of value and limit
  bool has_limit;            ///< else its limit is 0
  double max_limit;          ///< a limit is 0 to this
  std::string_view meaning;  ///< for people: "the fastest body is faster than this"
};
inline constexpr auto break_condition_names = std::to_array<BreakConditionName>({
    {BreakCondition::non_finite, "non-finite", "bodies", false, 0, "a body is not finite"},
    {BreakCondition::energy_rise, "energy-rise", "%", true, 1e9,
     "the energy has risen above that of the start by more than this part of the energy scale"},
    {BreakCondition::penetration, "penetration", "m", true, 1e9, "the deepest overlap is deeper than this"},
    {BreakCondition::speed, "speed", "m/s", true, 1e18, "the fastest body is faster than this"},
    {BreakCondition::stage_ms, "stage-ms", "ms", true, 1e9,
     "a stage took longer than this; every other step is timed by stage"},
    {BreakCondition::escaped, "escaped", "bodies", false, 0, "a centre is outside the box"},
});
constexpr const BreakConditionName& name_of(BreakCondition condition) {
  return break_condition_names[static_cast<std::size_t>(condition)];
}

/// The limit of each condition; unset: nobody asks.
struct BreakConditions {
  std::array<std::optional<double>, break_condition_names.size()> limits{};
  std::optional<double>& limit(BreakCondition condition) {
    return limits[static_cast<std::size_t>(condition)];
  }
  bool any() const {
    for (const std::optional<double>& limit : limits)
      if (limit) return true;
    return false;
  }
};

/// "non-finite,energy-rise=5,penetration=0.1". Throws InputError, a line for each part that is none, after
/// "--break: ".
BreakConditions parse_break_conditions(const std::string& list);

/// A condition that is met.
struct BreakpointHit {
  BreakCondition condition = BreakCondition::non_finite;
  std::int64_t step = 0;  ///< that led to the state
  std::string stage;      ///< of stage_ms; else empty: it is the state that is measured
  double value = 0, limit = 0;
  std::optional<std::uint32_t> body;  ///< stability/offending_body.h; where there is one
};

/// Watches one run from a state on.
class BreakpointMonitor {
 public:
  explicit BreakpointMonitor(const StepStats& start);
  /// Each state in turn, with the times of its step. The first condition that is met, in the order of the
  /// table: a value above its limit, or not a number. Energy is what it is without the work of pushes; its
  /// rise is over the largest kinetic energy and change of the potential one, together, of all states so far.
  std::optional<BreakpointHit> check(const BreakConditions& conditions, const StepStats& stats,
                                     const RunTimes& times);
  /// The run was changed at a state, measured before and after: energy that the change added is no rise.
  void change(const StepStats& before, const StepStats& after);

 private:
  double energy_, potential_, scale_ = 0;  ///< J
};

/// "speed: after step 12 body 3 has 103 m/s, over 100 m/s".
std::string describe(const BreakpointHit& hit);

}  // namespace collidoscope
