#pragma once
// Break conditions: conditions on a state and its last step at which a run stops. Plain data and functions
// over plain data. The caller measures each state, which costs about as much as finding its contacts once
// more.

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
  std::string_view name;     ///< as in --break
  std::string_view unit;     ///< of value and limit
  bool has_limit;            ///< false: the limit is 0
  double max_limit;          ///< largest allowed limit; the smallest is 0
  std::string_view meaning;  ///< "the largest speed exceeds this value"
};
inline constexpr auto break_condition_names = std::to_array<BreakConditionName>({
    {BreakCondition::non_finite, "non-finite", "bodies", false, 0, "a body is not finite"},
    {BreakCondition::energy_rise, "energy-rise", "%", true, 1e9,
     "the energy exceeds the initial energy by more than this fraction of the energy scale"},
    {BreakCondition::penetration, "penetration", "m", true, 1e9,
     "the largest penetration exceeds this depth"},
    {BreakCondition::speed, "speed", "m/s", true, 1e18, "the largest speed exceeds this value"},
    {BreakCondition::stage_ms, "stage-ms", "ms", true, 1e9,
     "a stage takes longer than this; every other step is timed by stage"},
    {BreakCondition::escaped, "escaped", "bodies", false, 0, "the centre of a body is outside the box"},
});
constexpr const BreakConditionName& name_of(BreakCondition condition) {
  return break_condition_names[static_cast<std::size_t>(condition)];
}

/// Limit of each condition; unset: the condition is off.
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

/// Parses a list such as "non-finite,energy-rise=5,penetration=0.1". Throws InputError with one line per
/// invalid part, prefixed by "--break: ".
BreakConditions parse_break_conditions(const std::string& list);

/// A condition that was met.
struct BreakpointHit {
  BreakCondition condition = BreakCondition::non_finite;
  std::int64_t step = 0;  ///< the step that led to the state
  std::string stage;      ///< name of the stage for stage_ms; otherwise empty
  double value = 0, limit = 0;
  std::optional<std::uint32_t> body;  ///< see stability/offending_body.h; unset if not applicable
};

/// Checks the conditions along one run.
class BreakpointMonitor {
 public:
  explicit BreakpointMonitor(const StepStats& start);
  /// Checks a state and the times of its step; call for each state in order. Returns the first condition,
  /// in the order of the table, whose value exceeds its limit or is NaN. Energy excludes push_work. The
  /// rise is relative to the largest sum of kinetic energy and |change of potential energy| so far.
  std::optional<BreakpointHit> check(const BreakConditions& conditions, const StepStats& stats,
                                     const RunTimes& times);
  /// Call after a change of the run, with the measurements before and after it. Energy added by the change
  /// does not count as a rise.
  void change(const StepStats& before, const StepStats& after);

 private:
  double energy_, potential_, scale_ = 0;  ///< J
};

/// One line: "speed: after step 12 body 3 has 103 m/s, over 100 m/s".
std::string describe(const BreakpointHit& hit);

}  // namespace collidoscope
