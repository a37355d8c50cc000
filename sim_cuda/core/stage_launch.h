#pragma once
// How a stage was launched, and why so: what "auto" chose, or what (B, T) came to. Plain data, gathered while
// a step is recorded (on the CPU, as it runs); read by panels, JSON and tests alike.

#include <array>
#include <cstdint>

namespace collidoscope {

/// What keeps more of a stage from running at once.
enum class LaunchLimit {
  unknown,
  items,          ///< there is no more work
  shape,          ///< (B, T) as asked for
  threads,        ///< of a multiprocessor; on the CPU, of the team
  blocks,         ///< of a multiprocessor
  registers,      ///< of a multiprocessor
  shared_memory,  ///< of a multiprocessor
};

/// As panels and JSON say it.
constexpr const char* name_of(LaunchLimit limit) {
  constexpr std::array names{"unknown",         "too few items", "B x T as asked for", "threads",
                             "resident blocks", "registers",     "shared memory"};
  return names[static_cast<std::size_t>(limit)];
}

/// Of a stage's kernels (CPU: loops) that obey (B, T), the one with the most items.
struct StageLaunch {
  std::int64_t items = 0;   ///< where only the device knows their number: the room for them
  std::int64_t blocks = 0;  ///< B; on the CPU, the pieces that the items are cut into
  int threads = 0;  ///< T; on the CPU, those of the team that share the pieces; 0: nothing obeys (B, T)
  std::int64_t chunk = 0;  ///< CPU: items in a piece, about; else 0
  // CUDA; else 0.
  int resident_blocks = 0;  ///< that one multiprocessor runs at once
  int multiprocessors = 0;
  int registers = 0;     ///< of a thread
  int shared_bytes = 0;  ///< of a block
  double occupancy = 0;  ///< threads of the resident blocks, as a share (0 to 1) of a multiprocessor's limit
  LaunchLimit limit = LaunchLimit::unknown;

  /// Blocks that the whole device runs at once.
  std::int64_t resident() const { return std::int64_t{resident_blocks} * multiprocessors; }
};

}  // namespace collidoscope
