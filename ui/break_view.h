#pragma once
// Data of the break conditions panel, and of the stop of a run. Plain structs: the panel writes the requests,
// the caller writes the view.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/run/break_conditions.h"

namespace collidoscope {

/// Texts of a condition, in the order of break_condition_names.
struct BreakConditionText {
  const char *label, *help;
};
inline constexpr std::array<BreakConditionText, break_condition_names.size()> break_condition_texts{
    {{"non-finite value", "Stops if a value of a body is not finite"},
     {"energy gain",
      "Stops if the energy exceeds the initial energy by more than this share, %. The share is of the "
      "largest "
      "kinetic energy and change of potential energy so far"},
     {"penetration", "Stops if the max penetration exceeds this depth, m"},
     {"speed", "Stops if the speed of a body exceeds this, m/s"},
     {"stage time", "Stops if a stage takes longer than this, ms. Odd-numbered steps are timed by stage"},
     {"body left box", "Stops if the centre of a body is outside the box"}}};

constexpr const BreakConditionText& break_text(BreakCondition condition) {
  return break_condition_texts[static_cast<std::size_t>(condition)];
}

/// Action at a stop.
enum class StopRequest { none, resume, freeze, save };

struct BreakRequests {
  std::array<bool, break_condition_names.size()> on{};  ///< conditions that are switched on
  std::array<double, break_condition_names.size()> limits{
      0, 5, 0.1, 100, 20, 0};            ///< in the unit of each condition; kept while switched off
  StopRequest stop = StopRequest::none;  ///< cleared by the caller

  double& limit(BreakCondition condition) { return limits[static_cast<std::size_t>(condition)]; }
  double limit(BreakCondition condition) const { return limits[static_cast<std::size_t>(condition)]; }

  /// Switches on exactly these conditions.
  void set_conditions(const BreakConditions& conditions) {
    for (std::size_t k = 0; k < on.size(); ++k) {
      on[k] = conditions.limits[k].has_value();
      limits[k] = conditions.limits[k].value_or(limits[k]);
    }
  }
  BreakConditions conditions() const {
    BreakConditions conditions;
    for (std::size_t k = 0; k < on.size(); ++k)
      if (on[k]) conditions.limits[k] = limits[k];
    return conditions;
  }
};

struct StopView {
  std::string what;  ///< one line: condition or stage, step, body, value
  /// Whether a guard stopped the run, at the state before the failing step. False: the state meets a
  /// condition.
  bool is_violation = false;
  std::optional<std::uint32_t> body;
  bool can_freeze = false;
  std::int64_t state_before = 0;  ///< state before the step that led to the stop
};

}  // namespace collidoscope
