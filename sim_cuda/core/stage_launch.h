#pragma once
// How a stage was launched, and the resource that limited it, for automatic and for requested (B, T). Plain
// data, recorded while a step is captured (CPU: executed). Read by panels, JSON export and tests.

#include <array>
#include <cstdint>

namespace collidoscope {

/// The factor that limits the concurrency of a stage.
enum class LaunchLimit {
  unknown,
  items,          ///< no more items
  shape,          ///< requested (B, T)
  threads,        ///< per multiprocessor; on the CPU, of the team
  blocks,         ///< per multiprocessor
  registers,      ///< per multiprocessor
  shared_memory,  ///< per multiprocessor
};

/// Name for panels and JSON.
constexpr const char* name_of(LaunchLimit limit) {
  constexpr std::array names{"unknown",         "too few items", "requested B x T", "threads",
                             "resident blocks", "registers",     "shared memory"};
  return names[static_cast<std::size_t>(limit)];
}

/// Describes the kernel (CPU: loop) with the most items among the kernels of a stage that obey (B, T).
struct StageLaunch {
  std::int64_t items = 0;   ///< an upper bound if only the device knows the number
  std::int64_t blocks = 0;  ///< B; on the CPU, the number of chunks
  int threads = 0;          ///< T; on the CPU, the threads that share the chunks; 0: no kernel obeys (B, T)
  std::int64_t chunk = 0;   ///< CPU: approximate items per chunk; GPU: 0
  // CUDA only; 0 on the CPU.
  int resident_blocks = 0;  ///< resident blocks per multiprocessor
  int multiprocessors = 0;
  int registers = 0;     ///< per thread
  int shared_bytes = 0;  ///< per block
  double occupancy = 0;  ///< resident threads as a share (0 to 1) of a multiprocessor's limit
  LaunchLimit limit = LaunchLimit::unknown;

  /// Resident blocks of the whole device.
  std::int64_t resident() const { return std::int64_t{resident_blocks} * multiprocessors; }
};

}  // namespace collidoscope
