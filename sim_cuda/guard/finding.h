#pragma once
// What a guard has found: the first value of a step that is not finite, or absurd. Plain data, SI units.

#include <cstdint>
#include <string>
#include <string_view>

namespace collidoscope {

enum class FindingQuantity { box, normal, acceleration, velocity, spin, position, orientation };

std::string_view name_of(FindingQuantity quantity);  ///< "velocity"
std::string_view unit_of(FindingQuantity quantity);  ///< "m/s", or "" where it has none

struct Finding {
  std::int64_t step = 0;   ///< that failed; it leads to the state of this number
  int substep = 1;         ///< of it, from 1; what follows all substeps counts to the last
  std::string stage;       ///< the first, in the order of the step, after which something was found
  std::uint32_t body = 0;  ///< the lowest id of what was found there; of a contact, its lower one
  FindingQuantity quantity = FindingQuantity::velocity;
  /// A component that is not finite, or the magnitude; of a box its farthest coordinate, and not a number
  /// where the box holds nothing, as that of a body does whose position or velocity is not finite.
  double value = 0;
  /// The body was bad in the state before the step already: what it shows is no fault of that stage.
  bool invalid_before = false;
};

/// "stage forces of step 8, substep 2: body 3 has the velocity 3.2e+10 m/s", and where it was so before: ",
/// as it had in state 7".
std::string describe(const Finding& finding);

}  // namespace collidoscope
