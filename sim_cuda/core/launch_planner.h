#pragma once
// Chooses how many blocks of how many threads a kernel is launched with.

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
  /// Shared memory that a block of so many threads needs beside its static variables, in bytes.
  using SharedBytes = std::size_t (*)(int threads);

  /// Both must outlive this object. Each shape that is chosen is noted in `stages`.
  LaunchPlanner(const ComputeDevice& device, StageRecorder& stages);

  /// Sets B and T; 0 is "auto". Both must be within the limits of the device.
  void set_shape(LaunchShape requested) { requested_ = requested; }

  /// (B, T) for a kernel with so many items. `shared` may be null. Where B is "auto", it is a thread for each
  /// item; with `at_once` no more blocks than run at once.
  LaunchShape choose_shape(const void* kernel, const char* name, std::int64_t items, bool at_once,
                           SharedBytes shared);
  /// (B, T) for a kernel whose threads wait for each other, so that all must run at once. Where "auto", about
  /// `blocks_per_multiprocessor` blocks to a multiprocessor. B = 0: the (B, T) asked for would be more than
  /// run at once.
  LaunchShape choose_cooperative_shape(const void* kernel, const char* name, std::int64_t items,
                                       int blocks_per_multiprocessor);

  /// How many threads run at once if each needs 64 registers.
  std::int64_t threads_at_once() const { return std::int64_t{1024} * device_.multiprocessors; }

 private:
  /// What CUDA reports about a kernel in blocks of so many threads.
  struct KernelFit {
    int threads, registers, shared_bytes, resident_blocks;
    double occupancy;
    LaunchLimit limit;
  };
  /// `threads` 0: the block size up to 128 with the most threads at once. CUDA is asked once for each kernel.
  const KernelFit& kernel_fit(const void* kernel, int threads, const char* name, SharedBytes shared);
  void note_shape(std::int64_t items, LaunchShape shape, const KernelFit& fit);

  const ComputeDevice& device_;
  StageRecorder& stages_;
  LaunchShape requested_;
  std::map<std::pair<const void*, int>, KernelFit> fits_;
};

/// Throws MachineError if the last launch failed.
void check_launch(const char* name, LaunchShape shape);

}  // namespace collidoscope

#endif
