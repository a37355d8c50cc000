#pragma once
// Occupancy limits: the computation of StageLaunch::limit. Pure functions. Block counts come from CUDA's
// occupancy calculator.

#include "sim_cuda/core/stage_launch.h"

namespace collidoscope {

/// Resources of one multiprocessor.
struct MultiprocessorLimits {
  int threads = 0, blocks = 0, shared_bytes = 0,
      reserved_bytes = 0;  ///< reserved_bytes: shared memory reserved per block
};

/// The resource that limits a multiprocessor to `resident` blocks of `threads` threads. `resident` comes from
/// the occupancy calculator. If threads, blocks and shared memory do not limit it, registers do.
LaunchLimit residency_limit(const MultiprocessorLimits& limits, int threads, int shared_bytes, int resident);

/// The factor that limits the concurrency of a launch of `blocks` blocks; `full` if the device is full.
/// `resident` as in StageLaunch. `needed`: number of blocks with items.
LaunchLimit launch_limit(std::int64_t blocks, std::int64_t needed, std::int64_t resident, LaunchLimit full);

}  // namespace collidoscope
