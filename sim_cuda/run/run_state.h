#pragma once
// Where a run stands: all that, beside its scene, decides how it goes on. On the host and in double, whatever
// the run's precision; bit-exact. Taken by World::state(), given to another world by World::restore(), kept
// in files by snapshot.h.

#include <cstdint>
#include <vector>

#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/run/body_states.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

struct RunState {
  std::int64_t steps = 0;
  BodyStates bodies;
  std::vector<StaticImpulse> static_impulses;  ///< by body; empty where there are no walls
  WarmStart warm_start;
  /// Of all settings but N: a world of others lets nothing sleep on.
  std::uint64_t settings = 0;
  std::vector<std::uint32_t> frozen;  ///< ids, ascending, of bodies that guards have fixed where they are
  /// s that were simulated since state 0; NaN: not known, of a snapshot that an older version wrote.
  double time = 0;
};

/// RunState::settings of a scene: a hash of all settings, but not of the bodies; 0 if nothing can sleep.
std::uint64_t settings_hash(Scene scene);

/// The same with other bodies: those of `ids` (see World::restore) with what is known of them, all others as
/// they are in `fresh`, which holds all there are then. What was between a body that is gone and another goes
/// with it, and the other has not been slow yet: it may have rested on what is gone.
RunState remap_bodies(const RunState& state, const BodyIdMap& ids, BodyStates fresh);

}  // namespace collidoscope
