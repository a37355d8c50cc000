#include "sim_cuda/core/compute_device.h"

#include <atomic>
#include <fstream>

#include "sim_cuda/core/error.h"

#if SIM_CUDA
#include "sim_cuda/core/cuda_check.h"
#endif

namespace collidoscope {

namespace {

std::atomic<bool> gpu_is_abandoned = false;

std::string cpu_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) {
      const auto colon = line.find(": ");
      if (colon != std::string::npos) return line.substr(colon + 2);
    }
  return "CPU";
}

#if SIM_CUDA
/// "NVRM version: NVIDIA UNIX x86_64 Kernel Module  580.95.05  ..." gives 580.
std::string driver_branch() {
  std::ifstream info("/proc/driver/nvidia/version");
  for (std::string word; info >> word && word != "GCC";)
    if (const std::size_t dot = word.find('.'); dot != word.npos && dot > 0)
      if (word.find_first_not_of("0123456789.") == word.npos) return word.substr(0, dot);
  int version = 0;
  check(cudaDriverGetVersion(&version), "query the driver");
  return "CUDA " + std::to_string(version / 1000) + '.' + std::to_string(version % 1000 / 10);
}
#endif

}  // namespace

bool cuda_available(std::string* why) {
#if SIM_CUDA
  int devices = 0;
  const cudaError_t status = cudaGetDeviceCount(&devices);
  if (status == cudaSuccess && devices > 0) return true;
  cudaGetLastError();
  if (why != nullptr)
    *why = status == cudaSuccess ? "CUDA found no device"
                                 : std::string("CUDA error: ") + cudaGetErrorString(status);
#else
  if (why != nullptr) *why = "this build has no CUDA support";
#endif
  return false;
}

void use_device_on_this_thread([[maybe_unused]] int gpu) {
#if SIM_CUDA
  if (gpu >= 0) check(cudaSetDevice(gpu), "use GPU " + std::to_string(gpu));
#endif
}

ComputeDevice open_device(const ExecutorOptions& options) {
  ComputeDevice device;
  std::string why;
  device.is_gpu = options.executor != ExecutorKind::cpu && cuda_available(&why);
  if (options.executor == ExecutorKind::cuda && !device.is_gpu)
    throw MachineError("the executor cuda cannot be used: " + why);
  if (!device.is_gpu) {
    device.name = cpu_name();
    return device;
  }
#if SIM_CUDA
  int devices = 0;
  check(cudaGetDeviceCount(&devices), "count devices");
  if (options.gpu < 0 || options.gpu >= devices)
    throw MachineError("GPU " + std::to_string(options.gpu) + " does not exist: this machine has GPUs 0 to " +
                       std::to_string(devices - 1));
  use_device_on_this_thread(options.gpu);
  cudaDeviceProp properties{};
  check(cudaGetDeviceProperties(&properties, options.gpu),
        "query the properties of GPU " + std::to_string(options.gpu));
  device.name = properties.name;
  device.driver = driver_branch();
  device.max_threads = properties.maxThreadsPerBlock;
  device.max_blocks = properties.maxGridSize[0];
  device.multiprocessors = properties.multiProcessorCount;
  device.limits = {properties.maxThreadsPerMultiProcessor, properties.maxBlocksPerMultiProcessor,
                   static_cast<int>(properties.sharedMemPerMultiprocessor),
                   static_cast<int>(properties.reservedSharedMemPerBlock)};
#endif
  return device;
}

void abandon_gpu() { gpu_is_abandoned = true; }

bool gpu_abandoned() { return gpu_is_abandoned; }

}  // namespace collidoscope
