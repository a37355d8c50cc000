#pragma once
// GPU kernels that run a stage once over its items, and their launches. Used by Executor::run and
// Executor::run_kernel.

#include "sim_cuda/core/item_count.h"

#if defined(__CUDACC__)
#include <cstddef>
#include <cstdint>

#include "sim_cuda/core/launch_planner.h"
#endif

namespace collidoscope {

/// A stage with large items: one item may take as long as thousands of others, such as a body with thousands
/// of contacts. On a GPU, all threads of a block process a large item together, after their other items.
///
///   SIM_HD bool is_large(int item) const;
///   __device__ void process_by_block(int item) const;  // the same result, bit for bit, as operator()(item)
template <class Stage>
concept LargeItems = requires(const Stage& stage) {
  stage.is_large(0);
};

#if defined(__CUDACC__)

/// Runs the items of one thread: `first`, and every `stride`-th after it.
template <class Stage>
__device__ void run_items(std::int64_t first, std::int64_t items, std::int64_t stride, const Stage& stage) {
  for (std::int64_t i = first; i < items; i += stride) stage(static_cast<int>(i));
}
template <LargeItems Stage>
__device__ void run_items(std::int64_t first, std::int64_t items, std::int64_t stride, const Stage& stage) {
  constexpr std::uint32_t capacity = 64;  // large items per block; further ones are run by a single thread
  __shared__ int queued[capacity];
  __shared__ std::uint32_t queued_count;
  if (threadIdx.x == 0) queued_count = 0;
  __syncthreads();
  for (std::int64_t i = first; i < items; i += stride) {
    const int item = static_cast<int>(i);
    if (stage.is_large(item))
      if (const std::uint32_t place = atomicAdd(&queued_count, 1); place < capacity) {
        queued[place] = item;
        continue;
      }
    stage(item);
  }
  __syncthreads();
  const std::uint32_t all = queued_count < capacity ? queued_count : capacity;
  for (std::uint32_t k = 0; k < all; ++k) {
    stage.process_by_block(queued[k]);
    __syncthreads();
  }
}

/// B x T threads run the items in a grid-stride loop, as in the paper. The launch bounds limit it to 64
/// registers, so that every T up to 1024 can be launched.
template <class Stage>
__global__ void __launch_bounds__(1024, 1) run_stage(const ItemCount count, const Stage stage) {
  run_items(static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x, count.value(),
            static_cast<std::int64_t>(gridDim.x) * blockDim.x, stage);
}

template <class Stage>
void launch_stage(LaunchPlanner& planner, cudaStream_t stream, const char* name, const ItemCount& count,
                  const Stage& stage) {
  const auto kernel = reinterpret_cast<const void*>(&run_stage<Stage>);
  // If the count is only an upper bound, launch at most the threads that run concurrently: most of the others
  // would have no item.
  const LaunchShape shape =
      planner.choose_shape(kernel, name, count.max, count.device_count != nullptr, nullptr);
  run_stage<Stage><<<shape.blocks, shape.threads, 0, stream>>>(count, stage);
  check_launch(name, shape);
}

/// Launch requirements of a kernel that is not a stage, because it uses warps or shared memory.
struct KernelNeeds {
  std::int64_t threads;  ///< number of threads with work
  bool at_once;          ///< automatic B: at most as many blocks as run concurrently
  /// Dynamic shared memory per block of T threads; null: none.
  LaunchPlanner::SharedBytes shared_bytes = nullptr;
};

template <class... Parameters, class... Arguments>
void launch_kernel(LaunchPlanner& planner, cudaStream_t stream, const char* name, const KernelNeeds& needs,
                   void (*kernel)(Parameters...), const Arguments&... arguments) {
  const LaunchShape shape = planner.choose_shape(reinterpret_cast<const void*>(kernel), name, needs.threads,
                                                 needs.at_once, needs.shared_bytes);
  const std::size_t shared = needs.shared_bytes != nullptr ? needs.shared_bytes(shape.threads) : 0;
  kernel<<<shape.blocks, shape.threads, shared, stream>>>(arguments...);
  check_launch(name, shape);
}

#endif

}  // namespace collidoscope
