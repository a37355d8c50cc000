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
