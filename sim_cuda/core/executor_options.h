#pragma once
// Options of an executor, and options that stages read from it. Plain data. No option changes the state;
// tests vary each field to check this.

#include <cstdint>
#include <string>

#include "sim_cuda/core/launch_shape.h"

namespace collidoscope {

class Cancellation;

enum class ExecutorKind { automatic, cpu, cuda };  ///< automatic: CUDA if a device is available, else the CPU

/// Distribution of items over the lanes of the CPU. `strided` and `shuffled` are test modes: they expose
/// stages whose items depend on each other.
enum class LaneOrder { contiguous, strided, shuffled };

/// Sort method for Morton keys. automatic: a counting sort into cells for few bodies, else the library.
enum class SortMethod { automatic, library, radix };  ///< radix: radix_sort.h, which obeys (B, T)

/// Whether the pairs of a plug-in are compared with those of lbvh_ropes, in each run of the pipeline.
enum class PairComparison { off, on };

/// Whether this build and this machine can run CUDA. If not, `why` (if not null) receives one line.
bool cuda_available(std::string* why = nullptr);

struct ExecutorOptions {
  ExecutorKind executor = ExecutorKind::automatic;
  int gpu = 0;          ///< device number, as in CUDA
  int cpu_threads = 0;  ///< 1 to 1024; 0: all hardware threads
  LaunchShape shape;
  StageShapes stage_shapes;  ///< instead of `shape`; names of other stages have no effect
  LaneOrder lane_order = LaneOrder::contiguous;
  int key_bits = 0;  ///< Morton keys: 24, 30 or 63; 0: automatic, by scene (broad_phase/key_bits.h)
  SortMethod sort = SortMethod::automatic;
  /// Each query reports all overlapping bodies, as in the paper: both bodies of a pair find it. Otherwise
  /// each pair is found once, from one side. Applies to bvh_bottom_up, bvh_recursive and lbvh_top_down.
  bool whole_queries = false;
  PairComparison check_pairs = PairComparison::off;  ///< no effect on built-in broad phases
  std::int64_t memory_limit = 0;  ///< bytes in the executor's memory space; 0: all available memory
  bool allow_large = false;       ///< allows all available memory, not only 80 % of it
  /// Cancels long work (cancellation.h). Optional: null disables cancellation. Not owned.
  Cancellation* cancellation = nullptr;
};

}  // namespace collidoscope
