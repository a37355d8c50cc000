#pragma once
// Result of a guard: the first value of a step that is not finite or exceeds a limit. Plain data, SI units.

#include <cstdint>
#include <string>
#include <string_view>

namespace collidoscope {

enum class FindingQuantity { box, normal, acceleration, velocity, spin, position, orientation };

std::string_view name_of(FindingQuantity quantity);  ///< "velocity"
std::string_view unit_of(FindingQuantity quantity);  ///< "m/s"; "" for dimensionless quantities

struct Finding {
  std::int64_t step = 0;   ///< the failed step; it leads to the state of this number
  int substep = 1;         ///< from 1; stages after the last substep count as the last substep
  std::string stage;       ///< first stage of the step whose output failed a check
  std::uint32_t body = 0;  ///< lowest id of the failed values; for a contact, its lower id
  FindingQuantity quantity = FindingQuantity::velocity;
  /// Non-finite component, or magnitude. Box: largest coordinate, or NaN if the box is empty. The box of a
  /// body whose position or velocity is not finite is empty.
  double value = 0;
  /// The body was already invalid in the state before the step, so the stage is not the cause.
  bool invalid_before = false;
};

/// "stage forces of step 8, substep 2: body 3 has the velocity 3.2e+10 m/s". With invalid_before, followed
/// by "; it was already invalid in state 7".
std::string describe(const Finding& finding);

}  // namespace collidoscope
