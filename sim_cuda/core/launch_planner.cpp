#include "sim_cuda/core/launch_planner.h"

#if SIM_CUDA

#include <algorithm>
#include <string>

#include "sim_cuda/core/cuda_check.h"
#include "sim_cuda/core/occupancy.h"

namespace collidoscope {

LaunchPlanner::LaunchPlanner(const ComputeDevice& device, StageRecorder& stages)
    : device_(device), stages_(stages) {}

const LaunchPlanner::KernelFit& LaunchPlanner::kernel_fit(const void* kernel, int threads, const char* name,
                                                          SharedBytes shared) {
  const auto known = fits_.find({kernel, threads});
  if (known != fits_.end()) return known->second;
  const std::string doing = std::string("compute the occupancy of stage ") + name;
  cudaFuncAttributes attributes{};
  check(cudaFuncGetAttributes(&attributes, kernel), doing);
  const auto shared_bytes = [&](int block) { return shared != nullptr ? shared(block) : 0; };
  constexpr std::size_t granted = 48 << 10;  // bytes; a kernel that needs more must request it
  if (const std::size_t max_shared = shared_bytes(device_.max_threads); max_shared > granted)
    check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                               static_cast<int>(max_shared)),
          doing);
  const auto resident = [&](int block) {
    int blocks = 0;
    check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel, block, shared_bytes(block)), doing);
    return blocks;
  };
  int best = threads, best_threads = 0;
  for (int block = 128; threads == 0 && block >= 32; block -= 32)
    if (const int at_once = resident(block) * block; at_once > best_threads) {
      best_threads = at_once;
      best = block;
    }
  KernelFit fit{};
  fit.threads = best;
  fit.registers = attributes.numRegs;
  fit.shared_bytes = static_cast<int>(attributes.sharedSizeBytes + shared_bytes(best));
  fit.resident_blocks = resident(best);
  fit.occupancy = static_cast<double>(fit.resident_blocks * 32 * ((best + 31) / 32)) / device_.limits.threads;
  fit.limit = residency_limit(device_.limits, best, fit.shared_bytes, fit.resident_blocks);
  return fits_.emplace(std::pair{kernel, threads}, fit).first->second;
}

LaunchShape LaunchPlanner::requested(const void* kernel, const char* name, SharedBytes shared) {
  const LaunchShape shape = shape_of_stage(stages_.stage(), requested_, by_stage_);
  if (only_if_they_fit_ && shape.threads > 0 &&
      kernel_fit(kernel, shape.threads, name, shared).resident_blocks == 0)
    return {};
  return shape;
}

LaunchShape LaunchPlanner::choose_shape(const void* kernel, const char* name, std::int64_t items,
                                        bool at_once, SharedBytes shared) {
  const LaunchShape requested = this->requested(kernel, name, shared);
  const KernelFit& fit = kernel_fit(kernel, requested.threads, name, shared);
  const std::int64_t needed = (items + fit.threads - 1) / fit.threads;
  const std::int64_t resident = std::int64_t{fit.resident_blocks} * device_.multiprocessors;
  LaunchShape shape{requested.blocks, fit.threads};
  // One thread per item: the hardware starts a block as soon as another ends, which balances queries of
  // unequal length.
  if (shape.blocks == 0) shape.blocks = static_cast<int>(at_once ? std::min(needed, resident) : needed);
  note_shape(items, shape, fit);
  return shape;
}

LaunchShape LaunchPlanner::choose_cooperative_shape(const void* kernel, const char* name, std::int64_t items,
                                                    int blocks_per_multiprocessor, int most_threads) {
  // At least one block per multiprocessor, to use the full memory bandwidth. At most two, because the cost of
  // a grid barrier grows with the number of blocks.
  const std::int64_t blocks = std::int64_t{device_.multiprocessors} * blocks_per_multiprocessor,
                     shared = (items + blocks - 1) / blocks;
  const int usual = static_cast<int>(std::clamp<std::int64_t>(
      (shared + 31) / 32 * 32, 64, std::min(most_threads, device_.max_threads / blocks_per_multiprocessor)));
  const LaunchShape requested = this->requested(kernel, name, nullptr);
  const int threads = requested.threads > 0 ? requested.threads : usual;
  const KernelFit& fit = kernel_fit(kernel, threads, name, nullptr);
  const std::int64_t resident = std::int64_t{fit.resident_blocks} * device_.multiprocessors;
  LaunchShape shape{requested.blocks, threads};
  if (shape.blocks > resident) return {0, 0};
  if (shape.blocks == 0) {
    const std::int64_t most = requested.threads > 0 ? resident : std::min(resident, blocks);
    shape.blocks = static_cast<int>(std::min((items + threads - 1) / threads, most));
  }
  note_shape(items, shape, fit);
  return shape;
}

void LaunchPlanner::note_shape(std::int64_t items, LaunchShape shape, const KernelFit& fit) {
  const std::int64_t needed = (items + fit.threads - 1) / fit.threads;
  const std::int64_t resident = std::int64_t{fit.resident_blocks} * device_.multiprocessors;
  stages_.note_launch({items, shape.blocks, shape.threads, 0, fit.resident_blocks, device_.multiprocessors,
                       fit.registers, fit.shared_bytes, fit.occupancy,
                       launch_limit(shape.blocks, needed, resident, fit.limit)});
}

void check_launch(const char* name, LaunchShape shape) {
  check(cudaPeekAtLastError(), std::string("launch stage ") + name + " as " + std::to_string(shape.blocks) +
                                   " blocks of " + std::to_string(shape.threads) + " threads");
}

}  // namespace collidoscope

#endif
