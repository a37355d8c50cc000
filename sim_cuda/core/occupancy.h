#pragma once
// Why no more of a kernel runs at once: the arithmetic behind StageLaunch::limit. Free functions; the counts
// come from CUDA's occupancy calculator.

#include "sim_cuda/core/stage_launch.h"

namespace collidoscope {

/// What one multiprocessor holds at most.
struct MultiprocessorLimits {
  int threads = 0, blocks = 0, shared_bytes = 0, reserved_bytes = 0;  ///< reserved: of each block's share
};

/// What keeps a multiprocessor from running more than `resident` blocks of `threads` threads, which the
/// occupancy calculator has counted. What is neither threads, blocks nor shared memory can only be registers.
LaunchLimit residency_limit(const MultiprocessorLimits& limits, int threads, int shared_bytes, int resident);

/// What keeps a launch of that many blocks from doing more at once: its `limit`, if the device is full.
/// `resident` as in StageLaunch; `needed`: blocks that have items.
LaunchLimit launch_limit(std::int64_t blocks, std::int64_t needed, std::int64_t resident, LaunchLimit full);

}  // namespace collidoscope
