#include "sim_cuda/core/memory_space.h"

#include <algorithm>
#include <limits>
#include <new>
#include <utility>
#include <vector>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/host_memory.h"

#if SIM_CUDA
#include "sim_cuda/core/cuda_check.h"
#endif

namespace collidoscope {

namespace {

constexpr std::align_val_t host_alignment{64};

/// Lists the four names with the most bytes, after adding `bytes` to `name`.
std::string largest_of(std::map<std::string, std::int64_t> bytes_by_name, const char* name,
                       std::size_t bytes) {
  bytes_by_name[name] += static_cast<std::int64_t>(bytes);
  std::vector<std::pair<std::int64_t, std::string>> by_size;
  for (const auto& [each, sum] : bytes_by_name) by_size.emplace_back(sum, each);
  std::sort(by_size.rbegin(), by_size.rend());
  constexpr std::size_t max_shown = 4;
  std::string text;
  for (std::size_t k = 0; k < by_size.size() && k < max_shown; ++k)
    text += (k > 0 ? ", '" : "'") + by_size[k].second + "' " + std::to_string(by_size[k].first);
  return text;
}

void free_memory(void* memory, [[maybe_unused]] bool on_device) {
#if SIM_CUDA
  // cudaFree() waits for the device. Its error is ignored, because it may come from an earlier call; the next
  // checked call reports it.
  if (on_device) {
    if (!gpu_abandoned()) cudaFree(memory);
    return;
  }
#endif
  ::operator delete(memory, host_alignment);
}

}  // namespace

MemorySpace::MemorySpace(const ComputeDevice& device, const ExecutorOptions& options)
    : device_(device), memory_limit_(options.memory_limit), allow_large_(options.allow_large) {}

std::int64_t MemorySpace::available_bytes() const {
  std::int64_t free_bytes = 0;
#if SIM_CUDA
  if (device_.is_gpu) {
    std::size_t free = 0, total = 0;
    check(cudaMemGetInfo(&free, &total), "query the free memory of the device");
    free_bytes = static_cast<std::int64_t>(free);
  }
#endif
  if (!device_.is_gpu) free_bytes = free_host_bytes();
  if (memory_limit_ > 0) free_bytes = std::min(free_bytes, memory_limit_ - allocated_bytes_);
  return std::max<std::int64_t>(free_bytes, 0);
}

std::int64_t MemorySpace::room_bytes() const {
  const std::int64_t available = available_bytes();
  if (memory_limit_ > 0 || allow_large_) return available;
  // Allocated host memory that was not yet written to still counts as available.
  const std::int64_t taken =
      device_.is_gpu ? allocated_bytes_ : std::min(allocated_bytes_, resident_host_bytes());
  if (available > std::numeric_limits<std::int64_t>::max() - taken) return available;
  return std::max<std::int64_t>((available + taken) / 5 * 4 - allocated_bytes_, 0);
}

std::int64_t MemorySpace::dry_run_construction(const std::function<void()>& make) {
  struct ResetOnExit {  // also if `make` throws
    bool& on;
    ~ResetOnExit() { on = false; }
  } imagined{is_construction_dry_run_};
  is_construction_dry_run_ = true;
  return dry_run_allocation(make);
}

std::int64_t MemorySpace::dry_run_allocation(const std::function<void()>& reserve) {
  struct ResetOnExit {  // also if `reserve` throws
    bool& on;
    ~ResetOnExit() { on = false; }
  } rehearsal{is_dry_run_};
  is_dry_run_ = true;
  dry_run_bytes_ = 0;
  reserve();
  return dry_run_bytes_;
}

void* MemorySpace::allocate(const char* name, std::size_t bytes) {
  if (bytes == 0) return nullptr;
  void* memory = nullptr;
  const auto refuse = [&](const std::string& answer) {
    throw MachineError(device_.name + ": allocation of " + std::to_string(bytes) + " bytes for '" + name +
                       "' failed, " + std::to_string(allocated_bytes_ + static_cast<std::int64_t>(bytes)) +
                       " bytes in total (largest: " + largest_of(bytes_by_name(), name, bytes) +
                       "): " + answer);
  };
  // Linux overcommits memory and kills a process that writes to more than exists. Therefore free memory is
  // checked before large allocations.
  constexpr std::size_t large = std::size_t{64} << 20;
  if ((memory_limit_ > 0 || (!device_.is_gpu && bytes >= large)) &&
      static_cast<std::int64_t>(bytes) > available_bytes())
    refuse(std::to_string(available_bytes()) + " bytes are free");
  if (!device_.is_gpu) {
    memory = ::operator new(bytes, host_alignment, std::nothrow);
    if (memory == nullptr) refuse("out of memory");
  }
#if SIM_CUDA
  if (device_.is_gpu) {
    const cudaError_t status = cudaMalloc(&memory, bytes);
    if (status != cudaSuccess) {
      cudaGetLastError();
      std::size_t free_bytes = 0, total_bytes = 0;
      cudaMemGetInfo(&free_bytes, &total_bytes);
      refuse(std::string(cudaGetErrorString(status)) + ", " + std::to_string(free_bytes) + " of " +
             std::to_string(total_bytes) + " bytes free");
    }
  }
#endif
  try {
    allocations_[memory] = {name, bytes};
  } catch (...) {
    free_memory(memory, device_.is_gpu);
    throw;
  }
  allocated_bytes_ += static_cast<std::int64_t>(bytes);
  return memory;
}

std::map<std::string, std::int64_t> MemorySpace::bytes_by_name() const {
  std::map<std::string, std::int64_t> bytes;
  for (const auto& [memory, allocation] : allocations_)
    bytes[allocation.name] += static_cast<std::int64_t>(allocation.bytes);
  return bytes;
}

void MemorySpace::release(void* memory, std::size_t bytes) {
  if (memory == nullptr) return;
  allocated_bytes_ -= static_cast<std::int64_t>(bytes);
  allocations_.erase(memory);
  free_memory(memory, device_.is_gpu);
}

}  // namespace collidoscope
