#pragma once
// Reduction in a fixed order: pairwise within chunks of 32 items, then again over the chunk sums until one is
// left. The tree depends on the number of items only, so CPU and GPU give identical bits for any (B, T). It
// is the same for chunks of any power of two; small chunks give a GPU more threads. Pairwise summation limits
// the error to O(log n) roundings (Higham 1993).

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/executor.h"

namespace collidoscope {

inline constexpr std::int64_t reduce_chunk = 32;

/// Number of scratch elements that reduce() needs.
inline std::size_t reduce_scratch_size(std::int64_t count) {
  std::size_t total = 1;
  while (count > 1) {
    count = (count + reduce_chunk - 1) / reduce_chunk;
    total += static_cast<std::size_t>(count);
  }
  return total;
}

/// Reduces one chunk. Load: `T operator()(std::int64_t item) const`. T needs a function `T combine(T, T)`,
/// found by argument-dependent lookup.
template <class T, class Load>
struct ReduceChunk {
  Load load;
  std::int64_t count;
  T* sums;

  SIM_HD void operator()(int chunk) const {
    const std::int64_t first = chunk * reduce_chunk;
    const std::int64_t last = first + reduce_chunk < count ? first + reduce_chunk : count;
    // A binary counter of partial sums: pending[d] holds the sum of 2^k neighbours, with k decreasing in d.
    T pending[6];
    int depth = 0;
    for (std::int64_t i = first; i < last; ++i) {
      T sum = load(i);
      for (std::int64_t k = i - first; k & 1; k >>= 1) sum = combine(pending[--depth], sum);
      pending[depth++] = sum;
    }
    T sum = pending[--depth];
    while (depth > 0) sum = combine(pending[--depth], sum);
    sums[chunk] = sum;
  }
};

template <class T>
struct LoadSum {
  const T* sums;
  SIM_HD T operator()(std::int64_t item) const { return sums[item]; }
};

#if !SIM_CUDA || defined(__CUDACC__)
/// Reduces load(0) ... load(count - 1), count >= 1. Returns the address of the future result, in the
/// executor's memory. `scratch` has reduce_scratch_size(count) elements.
template <class T, class Load>
const T* reduce(Executor& executor, const char* stage, std::int64_t count, const Load& load, T* scratch) {
  std::int64_t chunks = (count + reduce_chunk - 1) / reduce_chunk;
  executor.run(stage, chunks, ReduceChunk<T, Load>{load, count, scratch});
  while (chunks > 1) {
    const std::int64_t next = (chunks + reduce_chunk - 1) / reduce_chunk;
    executor.run(stage, next, ReduceChunk<T, LoadSum<T>>{{scratch}, chunks, scratch + chunks});
    scratch += chunks;
    chunks = next;
  }
  return scratch;
}
#endif

}  // namespace collidoscope
