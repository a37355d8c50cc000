#pragma once
// Chooses (B, T), the number of blocks and threads per block, for each kernel launch. GPU only.

#if SIM_CUDA

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "sim_cuda/core/compute_device.h"
#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/core/stage_recorder.h"

namespace collidoscope {

class LaunchPlanner {
 public:
  /// Dynamic shared memory per block of `threads` threads, in bytes.
  using SharedBytes = std::size_t (*)(int threads);

  /// Both must outlive this object. `stages` records each chosen shape.
  LaunchPlanner(const ComputeDevice& device, StageRecorder& stages);

  /// Sets B and T for all stages, and for single ones; 0 is automatic. Precondition: all are within the
  /// limits of the device. `only_if_they_fit`: where a kernel cannot have them, they are automatic.
  void set_shapes(LaunchShape requested, const StageShapes& by_stage, bool only_if_they_fit) {
    requested_ = requested;
    by_stage_ = by_stage;
    only_if_they_fit_ = only_if_they_fit;
  }

  /// (B, T) for a kernel with `items` items. `shared` may be null. Automatic B gives one thread per item;
  /// with `at_once`, at most as many blocks as run concurrently.
  LaunchShape choose_shape(const void* kernel, const char* name, std::int64_t items, bool at_once,
                           SharedBytes shared);
  /// (B, T) for a cooperative launch, in which all blocks must be resident. Automatic B gives about
  /// `blocks_per_multiprocessor` blocks per multiprocessor, automatic T at most `most_threads`. Returns B = 0
  /// if the requested (B, T) exceeds the resident blocks.
  LaunchShape choose_cooperative_shape(const void* kernel, const char* name, std::int64_t items,
                                       int blocks_per_multiprocessor, int most_threads);

  /// Number of resident threads if each needs 64 registers.
  std::int64_t threads_at_once() const { return std::int64_t{1024} * device_.multiprocessors; }

 private:
  /// Resource use and occupancy of a kernel for one block size, as reported by CUDA.
  struct KernelFit {
    int threads, registers, shared_bytes, resident_blocks;
    double occupancy;
    LaunchLimit limit;
  };
  /// `threads` 0: selects the block size up to 128 with the most resident threads. Results are cached per
  /// kernel and block size.
  const KernelFit& kernel_fit(const void* kernel, int threads, const char* name, SharedBytes shared);
  LaunchShape requested(const void* kernel, const char* name, SharedBytes shared);
  void note_shape(std::int64_t items, LaunchShape shape, const KernelFit& fit);

  const ComputeDevice& device_;
  StageRecorder& stages_;
  LaunchShape requested_;
  StageShapes by_stage_;
  bool only_if_they_fit_ = false;
  std::map<std::pair<const void*, int>, KernelFit> fits_;
};

/// Throws MachineError if the last launch failed.
void check_launch(const char* name, LaunchShape shape);

}  // namespace collidoscope

#endif
