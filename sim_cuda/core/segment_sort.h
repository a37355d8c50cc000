#pragma once
// Sorting a run of numbers inside one item of a stage.

#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Sorts values[0 .. count) ascending: insertion for the usual handful, heap sort (O(n log n), in place) for
/// the hub of a thousand contacts.
SIM_HD inline void sort_segment(std::uint32_t* values, std::int64_t count) {
  if (count <= 24) {
    for (std::int64_t i = 1; i < count; ++i) {
      const std::uint32_t value = values[i];
      std::int64_t k = i;
      for (; k > 0 && values[k - 1] > value; --k) values[k] = values[k - 1];
      values[k] = value;
    }
    return;
  }
  const auto sift = [values](std::int64_t root, std::int64_t end) {
    const std::uint32_t value = values[root];
    for (;;) {
      std::int64_t child = 2 * root + 1;
      if (child >= end) break;
      if (child + 1 < end && values[child + 1] > values[child]) ++child;
      if (values[child] <= value) break;
      values[root] = values[child];
      root = child;
    }
    values[root] = value;
  };
  for (std::int64_t root = count / 2; root-- > 0;) sift(root, count);
  for (std::int64_t end = count; end-- > 1;) {
    const std::uint32_t largest = values[0];
    values[0] = values[end];
    values[end] = largest;
    sift(0, end);
  }
}

#if defined(__CUDACC__)

/// The same by all threads of a block: a bitonic network (Batcher 1968) whose comparators all point upward,
/// so that a run of any length is one of 2^k with its end missing. What is nearer than a tile is compared in
/// shared memory.
inline __device__ void sort_segment_together(std::uint32_t* values, std::uint32_t count) {
  constexpr std::uint32_t tile_bits = 11, tile = 1u << tile_bits;
  __shared__ std::uint32_t near[tile];
  const auto compare = [](std::uint32_t* all, std::uint32_t low, std::uint32_t high, std::uint32_t end) {
    if (high >= end || all[low] <= all[high]) return;
    const std::uint32_t larger = all[low];
    all[low] = all[high];
    all[high] = larger;
  };
  // Of two sorted runs of 2^k, the first with the second backwards: afterwards none of it is above the other.
  const auto flip = [&](std::uint32_t* all, std::uint32_t k, std::uint32_t end) {
    const std::uint32_t last = (1u << k) - 1;
    for (std::uint32_t i = threadIdx.x; i >> k << (k + 1) < end; i += blockDim.x) {
      const std::uint32_t run = i >> k << (k + 1);
      compare(all, run + (i & last), run + 2 * last + 1 - (i & last), end);
    }
    __syncthreads();
  };
  // Those that are 2^k apart.
  const auto halve = [&](std::uint32_t* all, std::uint32_t k, std::uint32_t end) {
    for (std::uint32_t i = threadIdx.x; i >> k << (k + 1) < end; i += blockDim.x) {
      const std::uint32_t low = (i >> k << (k + 1)) + (i & ((1u << k) - 1));
      compare(all, low, low + (1u << k), end);
    }
    __syncthreads();
  };
  const auto in_tiles = [&](const auto& work) {
    for (std::uint32_t from = 0; from < count; from += tile) {
      const std::uint32_t here = min(tile, count - from);
      for (std::uint32_t k = threadIdx.x; k < here; k += blockDim.x) near[k] = values[from + k];
      __syncthreads();
      work(here);
      for (std::uint32_t k = threadIdx.x; k < here; k += blockDim.x) values[from + k] = near[k];
      __syncthreads();
    }
  };
  in_tiles([&](std::uint32_t here) {
    for (std::uint32_t k = 0; 1u << k < here; ++k) {
      flip(near, k, here);
      for (std::uint32_t apart = k; apart-- > 0;) halve(near, apart, here);
    }
  });
  for (std::uint32_t k = tile_bits; 1u << k < count; ++k) {
    flip(values, k, count);
    for (std::uint32_t apart = k; apart-- > tile_bits;) halve(values, apart, count);
    in_tiles([&](std::uint32_t here) {
      for (std::uint32_t apart = tile_bits; apart-- > 0;) halve(near, apart, here);
    });
  }
}

#endif

}  // namespace collidoscope
