#include "sim_cuda/core/occupancy.h"

namespace collidoscope {

LaunchLimit residency_limit(const MultiprocessorLimits& limits, int threads, int shared_bytes, int resident) {
  const int warps = (threads + 31) / 32;  // threads are allocated in whole warps
  if (resident >= limits.threads / (32 * warps)) return LaunchLimit::threads;
  if (resident >= limits.blocks) return LaunchLimit::blocks;
  if (shared_bytes > 0 && resident >= limits.shared_bytes / (shared_bytes + limits.reserved_bytes))
    return LaunchLimit::shared_memory;
  return LaunchLimit::registers;
}

LaunchLimit launch_limit(std::int64_t blocks, std::int64_t needed, std::int64_t resident, LaunchLimit full) {
  if (needed < resident && needed <= blocks) return LaunchLimit::items;
  return blocks < resident ? LaunchLimit::shape : full;
}

}  // namespace collidoscope
