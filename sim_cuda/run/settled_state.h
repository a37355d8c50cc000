#pragma once
// Where a scene of the variant `settled` begins. World's constructor asks for it. It is found by a World of
// its own, and so written above World: snapshot/presimulation.cpp.

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// The state at rest, as step 0; from the cache, or made and kept. The scene is valid. Throws as World does.
RunState settled_state(const Scene& scene, const RunOptions& options);

}  // namespace collidoscope
