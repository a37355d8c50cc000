#pragma once
// Frozen bodies: bodies that guards have made static after a failed step. Free functions over plain data.

#include <cstdint>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// True if the state of a body is finite and within the limits of `guards`.
bool is_valid_state(const BodyStates& bodies, std::uint32_t body, const ValidationSettings& guards);

/// Adds a body to the frozen bodies of `state`. If its pose is invalid, it is set to the initial pose.
void freeze(RunState& state, std::uint32_t body, const InitialBodies& initial,
            const ValidationSettings& guards);

/// Returns the bodies with those of `frozen` (ids) made static.
InitialBodies with_static_bodies(InitialBodies initial, const std::vector<std::uint32_t>& frozen);

}  // namespace collidoscope
