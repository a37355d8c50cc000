#pragma once
// Which body meets a condition for a stop (run/break_conditions.h). A free function.

#include <cstdint>
#include <optional>

#include "sim_cuda/run/break_conditions.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// The body that meets the condition in the current state: the lowest id that is not finite or outside, the
/// fastest, or the lower id of the deepest overlap. None if the condition is not about a single body.
std::optional<std::uint32_t> offending_body(World& world, BreakCondition condition);

}  // namespace collidoscope
