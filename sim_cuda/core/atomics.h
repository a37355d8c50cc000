#pragma once
// Atomic operations for stages. Integers only, because their results do not depend on the order of the
// operations. Relaxed memory order, except atomic_exchange().

#include <atomic>
#include <cstdint>
#include <type_traits>

#include "sim_cuda/core/host_device.h"

#if defined(__CUDACC__)
#include <cooperative_groups.h>
#include <cooperative_groups/reduce.h>
#include <cuda/atomic>
#endif

namespace collidoscope {

/// Returns the previous value.
SIM_HD inline std::uint32_t atomic_add(std::uint32_t* target, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(target, value);
#else
  return std::atomic_ref<std::uint32_t>(*target).fetch_add(value, std::memory_order_relaxed);
#endif
}

SIM_HD inline std::uint64_t atomic_add(std::uint64_t* target, std::uint64_t value) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
  return std::atomic_ref<std::uint64_t>(*target).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// Adds `numbers` (0 to 15) to a contended counter and returns the previous value. On a GPU, the active
/// threads of a warp share one atomic (warp aggregation by ballots).
SIM_HD inline std::uint64_t atomic_add_aggregated(std::uint64_t* counter, std::uint32_t numbers) {
#if defined(__CUDA_ARCH__)
  const auto group = cooperative_groups::coalesced_threads();
  const std::uint32_t below = (1u << group.thread_rank()) - 1;
  std::uint32_t before = 0, all = 0;
  for (int bit = 0; bit < 4; ++bit) {  // sums by the bits of the numbers, one ballot each
    const std::uint32_t set = group.ballot(numbers >> bit & 1);
    before += static_cast<std::uint32_t>(__popc(set & below)) << bit;
    all += static_cast<std::uint32_t>(__popc(set)) << bit;
  }
  unsigned long long first = 0;
  if (group.thread_rank() == 0) first = atomicAdd(reinterpret_cast<unsigned long long*>(counter), all);
  return group.shfl(first, 0) + before;
#else
  return std::atomic_ref<std::uint64_t>(*counter).fetch_add(numbers, std::memory_order_relaxed);
#endif
}

/// Adds `values` to `count` consecutive targets. On a GPU, the active threads of a warp with the same targets
/// share one atomic per target. For contended targets. A full warp with the same targets, the usual case in
/// a large island, adds by shuffles, because a labelled partition costs more.
template <std::uint32_t count>
SIM_HD void atomic_add_aggregated(std::uint64_t* targets, const std::uint64_t (&values)[count]) {
#if defined(__CUDA_ARCH__)
  namespace groups = cooperative_groups;
  constexpr unsigned all = 0xffffffffu;
  int same = 0;
  if (__activemask() == all) __match_all_sync(all, reinterpret_cast<unsigned long long>(targets), &same);
  if (same != 0) {
    for (std::uint32_t k = 0; k < count; ++k) {
      auto sum = static_cast<unsigned long long>(values[k]);
      if (__any_sync(all, sum != 0) == 0) continue;
      for (unsigned lanes = 16; lanes > 0; lanes /= 2) sum += __shfl_xor_sync(all, sum, lanes);
      if (threadIdx.x % 32 == 0) atomicAdd(reinterpret_cast<unsigned long long*>(targets + k), sum);
    }
    return;
  }
  const auto group =
      groups::labeled_partition(groups::coalesced_threads(), reinterpret_cast<unsigned long long>(targets));
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto sum =
        groups::reduce(group, static_cast<unsigned long long>(values[k]), groups::plus<unsigned long long>());
    if (group.thread_rank() == 0) atomicAdd(reinterpret_cast<unsigned long long*>(targets + k), sum);
  }
#else
  for (std::uint32_t k = 0; k < count; ++k)
    if (values[k] != 0) atomic_add(targets + k, values[k]);
#endif
}

/// Adds `numbers` of any size, with a prefix sum over the active lanes of the warp.
SIM_HD inline std::uint32_t atomic_add_aggregated(std::uint32_t* counter, std::uint32_t numbers) {
#if defined(__CUDA_ARCH__)
  const auto group = cooperative_groups::coalesced_threads();
  std::uint32_t sum = numbers;
  for (unsigned step = 1; step < group.size(); step *= 2) {
    const std::uint32_t below = group.shfl_up(sum, step);
    if (group.thread_rank() >= step) sum += below;
  }
  const unsigned last = group.size() - 1;
  std::uint32_t first = 0;
  if (group.thread_rank() == last) first = atomicAdd(counter, sum);
  return group.shfl(first, last) + sum - numbers;
#else
  return atomic_add(counter, numbers);
#endif
}

/// Adds 1 to a contended counter and returns the previous value. On a GPU, the active threads of a warp with
/// the same counter share one atomic.
SIM_HD inline std::uint32_t atomic_count_labelled(std::uint32_t* counter) {
#if defined(__CUDA_ARCH__)
  const auto group = cooperative_groups::labeled_partition(cooperative_groups::coalesced_threads(),
                                                           reinterpret_cast<unsigned long long>(counter));
  std::uint32_t first = 0;
  if (group.thread_rank() == 0) first = atomicAdd(counter, static_cast<unsigned>(group.size()));
  return group.shfl(first, 0) + static_cast<std::uint32_t>(group.thread_rank());
#else
  return atomic_add(counter, std::uint32_t{1});
#endif
}

/// Atomic exchange with acquire-release order. Returns the previous value.
template <class T>
SIM_HD T atomic_exchange(T* target, std::type_identity_t<T> value) {
#if defined(__CUDA_ARCH__)
  return cuda::atomic_ref<T, cuda::thread_scope_device>(*target).exchange(value, cuda::memory_order_acq_rel);
#else
  return std::atomic_ref<T>(*target).exchange(value, std::memory_order_acq_rel);
#endif
}

/// Stores `value` if the target equals `expected`. Returns the previous value.
SIM_HD inline std::uint32_t atomic_compare_exchange(std::uint32_t* target, std::uint32_t expected,
                                                    std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  return atomicCAS(target, expected, value);
#else
  std::atomic_ref<std::uint32_t>(*target).compare_exchange_strong(expected, value, std::memory_order_relaxed);
  return expected;
#endif
}

SIM_HD inline std::uint64_t atomic_compare_exchange(std::uint64_t* target, std::uint64_t expected,
                                                    std::uint64_t value) {
#if defined(__CUDA_ARCH__)
  return atomicCAS(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(expected),
                   static_cast<unsigned long long>(value));
#else
  std::atomic_ref<std::uint64_t>(*target).compare_exchange_strong(expected, value, std::memory_order_relaxed);
  return expected;
#endif
}

/// Returns whether the value was lower than the target, and was stored.
SIM_HD inline bool atomic_min(std::uint32_t* target, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  return atomicMin(target, value) > value;
#else
  std::atomic_ref<std::uint32_t> cell(*target);
  std::uint32_t seen = cell.load(std::memory_order_relaxed);
  while (seen > value && !cell.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
  return seen > value;
#endif
}

SIM_HD inline void atomic_min(std::uint64_t* target, std::uint64_t value) {
#if defined(__CUDA_ARCH__)
  atomicMin(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
  std::atomic_ref<std::uint64_t> cell(*target);
  std::uint64_t seen = cell.load(std::memory_order_relaxed);
  while (seen > value && !cell.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}

/// Atomic maximum without the read first. For targets with little contention.
SIM_HD inline void atomic_max_unchecked(std::uint64_t* target, std::uint64_t value) {
#if defined(__CUDA_ARCH__)
  atomicMax(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
  std::atomic_ref<std::uint64_t> cell(*target);
  std::uint64_t seen = cell.load(std::memory_order_relaxed);
  while (seen < value && !cell.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}

/// Atomic maximum that reads first: most values at a contended target are lower than the stored one, and a
/// load costs far less than an atomic.
SIM_HD inline void atomic_max(std::uint64_t* target, std::uint64_t value) {
#if defined(__CUDA_ARCH__)
  static_assert(sizeof(unsigned long long) == sizeof(std::uint64_t));
  if (*reinterpret_cast<volatile std::uint64_t*>(target) >= value) return;
#endif
  atomic_max_unchecked(target, value);
}

SIM_HD inline void atomic_max(std::uint32_t* target, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  if (*reinterpret_cast<volatile std::uint32_t*>(target) >= value) return;
  atomicMax(target, value);
#else
  std::atomic_ref<std::uint32_t> cell(*target);
  std::uint32_t seen = cell.load(std::memory_order_relaxed);
  while (seen < value && !cell.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}

SIM_HD inline void atomic_or(std::uint32_t* target, std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
  atomicOr(target, bits);
#else
  std::atomic_ref<std::uint32_t>(*target).fetch_or(bits, std::memory_order_relaxed);
#endif
}

/// Loads a value that other threads may store concurrently.
template <class T>
SIM_HD T atomic_load(const T* source) {
#if defined(__CUDA_ARCH__)
  return *reinterpret_cast<const volatile T*>(source);
#else
  return std::atomic_ref<T>(*const_cast<T*>(source)).load(std::memory_order_relaxed);
#endif
}

/// Stores a value; other threads may concurrently store the same value only. Skips the store if the target
/// already has the value, to avoid cache-line contention.
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

/// Adds to a value that one thread after another changes. The threads hand over by relaxed stores, as in
/// SyncFreeRounds.
SIM_HD inline void add_in_turn(double* target, double value) {
#if defined(__CUDA_ARCH__)
  __threadfence();
  auto* cell = reinterpret_cast<volatile double*>(target);
  *cell = *cell + value;
  __threadfence();
#else
  *target += value;
#endif
}

}  // namespace collidoscope
