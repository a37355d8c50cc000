#pragma once
// Sorts a run of values within one stage item. A run is any type with `Value get(i)` and `put(i, value)`, so
// that its values need not be contiguous.

#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

struct NumberSegment {
  using Value = std::uint32_t;
  static constexpr std::uint32_t tile_bits = 11;  ///< 2^tile_bits values fit in a block's shared memory
  std::uint32_t* numbers;
  SIM_HD Value get(std::int64_t i) const { return numbers[i]; }
  SIM_HD void put(std::int64_t i, Value value) const { numbers[i] = value; }
};

/// Keys with body ids; ordered by (key, id).
struct KeyedSegment {
  using Value = std::uint64_t;
  /// 4 KiB, so that it does not reduce the resident blocks of the kernel.
  static constexpr std::uint32_t tile_bits = 9;
  std::uint32_t *keys, *ids;
  SIM_HD Value get(std::int64_t i) const { return std::uint64_t{keys[i]} << 32 | ids[i]; }
  SIM_HD void put(std::int64_t i, Value value) const {
    keys[i] = static_cast<std::uint32_t>(value >> 32);
    ids[i] = static_cast<std::uint32_t>(value);
  }
};

/// Sorts the first `count` values in ascending order. Insertion sort for up to 24 values; in-place heap sort,
/// O(n log n), for bodies with very many contacts.
template <class Run>
SIM_HD void sort_run(const Run& run, std::int64_t count) {
  using Value = typename Run::Value;
  if (count <= 24) {
    for (std::int64_t i = 1; i < count; ++i) {
      const Value value = run.get(i);
      std::int64_t k = i;
      for (; k > 0 && run.get(k - 1) > value; --k) run.put(k, run.get(k - 1));
      run.put(k, value);
    }
    return;
  }
  const auto sift = [&run](std::int64_t root, std::int64_t end) {
    const Value value = run.get(root);
    for (;;) {
      std::int64_t child = 2 * root + 1;
      if (child >= end) break;
      if (child + 1 < end && run.get(child + 1) > run.get(child)) ++child;
      if (run.get(child) <= value) break;
      run.put(root, run.get(child));
      root = child;
    }
    run.put(root, value);
  };
  for (std::int64_t root = count / 2; root-- > 0;) sift(root, count);
  for (std::int64_t end = count; end-- > 1;) {
    const Value largest = run.get(0);
    run.put(0, run.get(end));
    run.put(end, largest);
    sift(0, end);
  }
}

SIM_HD inline void sort_segment(std::uint32_t* values, std::int64_t count) {
  sort_run(NumberSegment{values}, count);
}

#if defined(__CUDACC__)

/// The part of a run that is in shared memory.
template <class Number>
struct SortTile {
  Number* values;
  __device__ Number get(std::uint32_t i) const { return values[i]; }
  __device__ void put(std::uint32_t i, Number value) const { values[i] = value; }
};

/// Sorts a run with all threads of a block: a bitonic sorting network (Batcher 1968) whose comparators all
/// point upward. A run of any length is therefore one of 2^k with its end missing. Comparisons within a tile
/// use shared memory.
template <class Run>
__device__ void sort_run_by_block(const Run& run, std::uint32_t count) {
  using Value = typename Run::Value;
  constexpr std::uint32_t tile_bits = Run::tile_bits, tile = 1u << tile_bits;
  __shared__ Value shared[tile];
  const auto compare = [](const auto& all, std::uint32_t low, std::uint32_t high, std::uint32_t end) {
    if (high >= end) return;
    const Value first = all.get(low), second = all.get(high);
    if (first <= second) return;
    all.put(low, second);
    all.put(high, first);
  };
  // First merge step: compares the first of two sorted runs of 2^k with the second in reverse. Afterwards no
  // value of the first exceeds any value of the second.
  const auto merge_flipped = [&](const auto& all, std::uint32_t k, std::uint32_t end) {
    const std::uint32_t last = (1u << k) - 1;
    for (std::uint32_t i = threadIdx.x; i >> k << (k + 1) < end; i += blockDim.x) {
      const std::uint32_t begin = i >> k << (k + 1);
      compare(all, begin + (i & last), begin + 2 * last + 1 - (i & last), end);
    }
    __syncthreads();
  };
  // Compares values at distance 2^k.
  const auto compare_apart = [&](const auto& all, std::uint32_t k, std::uint32_t end) {
    for (std::uint32_t i = threadIdx.x; i >> k << (k + 1) < end; i += blockDim.x) {
      const std::uint32_t low = (i >> k << (k + 1)) + (i & ((1u << k) - 1));
      compare(all, low, low + (1u << k), end);
    }
    __syncthreads();
  };
  const auto for_each_tile = [&](const auto& work) {
    for (std::uint32_t from = 0; from < count; from += tile) {
      const std::uint32_t here = min(tile, count - from);
      for (std::uint32_t k = threadIdx.x; k < here; k += blockDim.x) shared[k] = run.get(from + k);
      __syncthreads();
      work(here);
      for (std::uint32_t k = threadIdx.x; k < here; k += blockDim.x) run.put(from + k, shared[k]);
      __syncthreads();
    }
  };
  for_each_tile([&](std::uint32_t here) {
    for (std::uint32_t k = 0; 1u << k < here; ++k) {
      merge_flipped(SortTile<Value>{shared}, k, here);
      for (std::uint32_t apart = k; apart-- > 0;) compare_apart(SortTile<Value>{shared}, apart, here);
    }
  });
  for (std::uint32_t k = tile_bits; 1u << k < count; ++k) {
    merge_flipped(run, k, count);
    for (std::uint32_t apart = k; apart-- > tile_bits;) compare_apart(run, apart, count);
    for_each_tile([&](std::uint32_t here) {
      for (std::uint32_t apart = tile_bits; apart-- > 0;) compare_apart(SortTile<Value>{shared}, apart, here);
    });
  }
}

inline __device__ void sort_segment_by_block(std::uint32_t* values, std::uint32_t count) {
  sort_run_by_block(NumberSegment{values}, count);
}

#endif

}  // namespace collidoscope
