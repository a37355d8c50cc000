#pragma once
// How an executor runs stages, and what stages look up there. Nothing in here changes the state: that is the
// first promise, and every field is there to be varied in a test of it. Plain data.

#include <cstdint>
#include <string>

#include "sim_cuda/core/launch_shape.h"

namespace collidoscope {

class Cancellation;

enum class ExecutorKind { automatic, cpu, cuda };  ///< automatic: CUDA where there is a device, else the CPU

/// Which items each lane of the CPU takes. The last two are test modes: they expose a stage whose items
/// depend on each other.
enum class LaneOrder { contiguous, strided, shuffled };

/// How Morton keys are sorted. automatic: by counting in cells where there are few bodies, else the library.
enum class SortMethod { automatic, library, radix };  ///< radix: radix_sort.h, which obeys (B, T)

/// Whether this build and this machine can run CUDA; if not, `why` (where given) receives one line.
bool cuda_available(std::string* why = nullptr);

struct ExecutorOptions {
  ExecutorKind executor = ExecutorKind::automatic;
  int gpu = 0;          ///< CUDA's number of the device
  int cpu_threads = 0;  ///< 1 to 1024; 0: as many as the machine has
  LaunchShape shape;
  LaneOrder lane_order = LaneOrder::contiguous;
  int key_bits = 0;  ///< Morton keys: 24, 30 or 63; 0: what the scene calls for (key_bits.h)
  SortMethod sort = SortMethod::automatic;
  /// Each body's query looks for all that it overlaps, so that both bodies of a pair find it, as in the
  /// paper. Else each pair is found once, from one side. Of bvh_bottom_up, bvh_recursive and lbvh_top_down.
  bool whole_queries = false;
  std::int64_t memory_limit = 0;  ///< bytes in the executor's memory space; 0: all available memory
  bool allow_large = false;       ///< takes all memory that is available, not only 80 % of it
  /// Ends long work (cancellation.h); null: nothing does. Not owned.
  Cancellation* cancellation = nullptr;
};

}  // namespace collidoscope
