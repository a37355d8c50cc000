#pragma once
// Which body meets a condition for a stop (run/break_conditions.h). A free function.

#include <cstdint>
#include <optional>

#include "sim_cuda/run/break_conditions.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// The body that breaks it, at the state that the world is in: the lowest id of what is not finite or
/// outside, the fastest, that of the deepest overlap (the lower id of two). Nobody, where it is no single
/// body's.
std::optional<std::uint32_t> culprit(World& world, Condition condition);

}  // namespace collidoscope
