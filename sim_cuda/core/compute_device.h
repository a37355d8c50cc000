#pragma once
// The processor that an executor uses: a GPU, or the CPU of this machine.

#include <string>

#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/core/occupancy.h"

namespace collidoscope {

/// Plain data, constant after open_device().
struct ComputeDevice {
  bool is_gpu = false;
  std::string name;  ///< from CUDA or /proc/cpuinfo
  // GPU only.
  std::string driver;           ///< branch of the NVIDIA driver, "580"; else its CUDA version
  int max_threads = 1024;       ///< per block
  int max_blocks = 2147483647;  ///< per launch
  int multiprocessors = 0;
  MultiprocessorLimits limits;
};

/// Selects the processor according to the options and returns its properties. A GPU becomes the CUDA device
/// of the calling thread. Throws MachineError if the processor is not available.
ComputeDevice open_device(const ExecutorOptions& options);

/// Makes the GPU the CUDA device of the calling thread, as open_device() does for the thread that opens it.
/// Required on each thread that uses a World. -1, the CPU: does nothing. Throws MachineError.
void use_device_on_this_thread(int gpu);

/// Call this when work is cancelled while a GPU executes it. The process is expected to end soon. Afterwards,
/// GPU memory, streams and events are left to the operating system, because releasing them would wait for the
/// GPU. Applies to the whole process.
void abandon_gpu();
bool gpu_abandoned();

}  // namespace collidoscope
