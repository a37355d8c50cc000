#pragma once
// Finds the body that meets a stop condition (run/break_conditions.h). Stateless.

#include <cstdint>
#include <optional>

#include "sim_cuda/run/break_conditions.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// The body that meets the condition in the current state: the lowest id that is not finite or outside, the
/// fastest body, or the lower id of the deepest overlap. Unset if the condition does not refer to a single
/// body.
std::optional<std::uint32_t> offending_body(World& world, BreakCondition condition);

}  // namespace collidoscope
