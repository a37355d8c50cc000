#pragma once
// What the panel of break conditions shows and asks for, and what a run has stopped at. Plain data: the
// wishes are the panel's, the facts their owner's.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/run/break_conditions.h"

namespace collidoscope {

/// What is to be done where a run has stopped.
enum class StopWish { none, go_on, freeze, save };

struct BreakWishes {
  std::array<bool, condition_names.size()> on{};  ///< who is asked for
  std::array<double, condition_names.size()> limits{0,   5,  0.1,
                                                    100, 20, 0};  ///< in their units, kept while off
  StopWish stop = StopWish::none;                                 ///< cleared by the owner

  double& limit(Condition condition) { return limits[static_cast<std::size_t>(condition)]; }
  double limit(Condition condition) const { return limits[static_cast<std::size_t>(condition)]; }

  /// For these, and no others.
  void ask(const BreakConditions& conditions) {
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

struct StopFacts {
  std::string what;  ///< a line: condition or stage, step, body, value
  /// A guard has found it: the state is the one before that step. Else a condition is met by the state.
  bool found = false;
  std::optional<std::uint32_t> body;
  bool can_freeze = false;
  std::int64_t before = 0;  ///< the state before the step
};

}  // namespace collidoscope
