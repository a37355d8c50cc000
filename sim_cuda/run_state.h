#pragma once
// Where a run stands: all that, beside its scene, decides how it goes on. On the host and in double, whatever
// the run's precision; bit-exact. Taken by World::state(), given to another world by World::adopt(), kept in
// files by snapshot.h.

#include <cstdint>
#include <vector>

#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/solver/solver_memory.h"
#include "sim_cuda/world.h"

namespace collidoscope {

struct RunState {
  std::int64_t steps = 0;
  BodyStates bodies;
  std::vector<WallLedger> ledgers;  ///< by body; empty where there are no walls
  SolverMemory memory;
  /// Of all settings but N: a world of others lets nothing sleep on.
  std::uint64_t settings = 0;
};

}  // namespace collidoscope
