#pragma once
// Initial state of a scene of the variant `settled`, for World's constructor. It is computed by a separate
// World, so the implementation is in a higher layer: snapshot/presimulation.cpp.

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Returns the state at rest as state 0, from the cache or by simulation. Precondition: the scene is valid.
/// Throws as World does.
RunState settled_state(const Scene& scene, const RunOptions& options);

}  // namespace collidoscope
