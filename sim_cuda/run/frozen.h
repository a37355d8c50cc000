#pragma once
// Bodies that were fixed where they are since a step of theirs failed. Free functions over plain data.

#include <cstdint>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Whether a body is finite and nothing about it beyond what guards allow.
bool is_valid_state(const BodyStates& bodies, std::uint32_t body, const ValidationSettings& guards);

/// Adds a body to those of `state` that are frozen, at rest where it is; or where it started, if it is
/// nowhere that makes sense.
void freeze(RunState& state, std::uint32_t body, const InitialBodies& initial,
            const ValidationSettings& guards);

/// The bodies with those of `frozen` (ids) as what no force moves.
InitialBodies with_static_bodies(InitialBodies initial, const std::vector<std::uint32_t>& frozen);

}  // namespace collidoscope
