#pragma once
// What the panel of break conditions shows and asks for, and what a run has stopped at. Plain data: the
// requests are the panel's, the view its owner's.

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

/// What is to be done where a run has stopped.
enum class StopRequest { none, resume, freeze, save };

struct BreakRequests {
  std::array<bool, break_condition_names.size()> on{};  ///< who is asked for
  std::array<double, break_condition_names.size()> limits{0,   5,  0.1,
                                                          100, 20, 0};  ///< in their units, kept while off
  StopRequest stop = StopRequest::none;                                 ///< cleared by the owner

  double& limit(BreakCondition condition) { return limits[static_cast<std::size_t>(condition)]; }
  double limit(BreakCondition condition) const { return limits[static_cast<std::size_t>(condition)]; }

  /// For these, and no others.
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
  std::string what;  ///< a line: condition or stage, step, body, value
  /// A guard has found it: the state is the one before that step. Else a condition is met by the state.
  bool is_violation = false;
  std::optional<std::uint32_t> body;
  bool can_freeze = false;
  std::int64_t state_before = 0;  ///< the state before the step
};

}  // namespace collidoscope
