#pragma once
// The atomics that stages may use: on integers only, where the order of arrival cannot change the outcome.

#include <atomic>
#include <cstdint>

#include "sim_cuda/core/host_device.h"

#if defined(__CUDACC__)
#include <cooperative_groups.h>
#endif

namespace collidoscope {

/// Adds and returns the value before.
SIM_HD inline std::uint32_t atomic_add(std::uint32_t* target, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(target, value);
#else
  return std::atomic_ref<std::uint32_t>(*target).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// Takes the next number of a counter that many take from at once: on a GPU, the threads of a warp that
/// arrive together share one atomic.
SIM_HD inline std::uint64_t atomic_next(std::uint64_t* counter) {
#if defined(__CUDA_ARCH__)
  const auto group = cooperative_groups::coalesced_threads();
  unsigned long long first = 0;
  if (group.thread_rank() == 0)
    first = atomicAdd(reinterpret_cast<unsigned long long*>(counter), group.size());
  return group.shfl(first, 0) + group.thread_rank();
#else
  return std::atomic_ref<std::uint64_t>(*counter).fetch_add(1, std::memory_order_relaxed);
#endif
}

/// Looks before it bids: most bids at a busy place are lower than what stands there, and a load costs far
/// less than an atomic.
SIM_HD inline void atomic_max(std::uint64_t* target, std::uint64_t value) {
#if defined(__CUDA_ARCH__)
  static_assert(sizeof(unsigned long long) == sizeof(std::uint64_t));
  if (*reinterpret_cast<volatile std::uint64_t*>(target) >= value) return;
  atomicMax(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
  std::atomic_ref<std::uint64_t> cell(*target);
  std::uint64_t seen = cell.load(std::memory_order_relaxed);
  while (seen < value && !cell.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}

/// A load beside which others may store.
SIM_HD inline std::uint32_t atomic_load(const std::uint32_t* source) {
#if defined(__CUDA_ARCH__)
  return *reinterpret_cast<const volatile std::uint32_t*>(source);
#else
  return std::atomic_ref<std::uint32_t>(*const_cast<std::uint32_t*>(source)).load(std::memory_order_relaxed);
#endif
}

/// A store that others may make at the same time, all of the same value. Left out where the value stands
/// already, so that a busy cache line is not passed around.
template <class T>
SIM_HD void atomic_store(T* target, T value) {
#if defined(__CUDA_ARCH__)
  auto* cell = reinterpret_cast<volatile T*>(target);
  if (*cell != value) *cell = value;
#else
  std::atomic_ref<T> cell(*target);
  if (cell.load(std::memory_order_relaxed) != value) cell.store(value, std::memory_order_relaxed);
#endif
}

}  // namespace collidoscope
