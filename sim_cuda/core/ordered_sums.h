#pragma once
// Sums of vectors over a list, added in list order. Computed by one thread, or by a block with bitwise
// identical results: all threads load entries, a few threads add them.

#include <cstdint>

#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Each list entry has one vector per element of `sum_of`. The k-th vector is added to sum sum_of[k].
template <class Real, int... sum_of>
struct OrderedSums {
  static constexpr int vectors = sizeof...(sum_of);
  SIM_HD static constexpr int sum_of_vector(int k) {
    const int sums[] = {sum_of...};
    return sums[k];
  }
  static constexpr int count = sum_of_vector(vectors - 1) + 1;  // sums are numbered in ascending order

  Vector3<Real> sum[count];

  /// `entry(k, vectors)` writes the vectors of entry k.
  template <class Entry>
  SIM_HD static OrderedSums accumulate(std::uint32_t entries, const Entry& entry) {
    OrderedSums sums;
    for (Vector3<Real>& each : sums.sum) each = Vector3<Real>::Zero();
    for (std::uint32_t k = 0; k < entries; ++k) {
      Vector3<Real> vector[vectors];
      entry(k, vector);
      for (int v = 0; v < vectors; ++v) sums.sum[sum_of_vector(v)] += vector[v];
    }
    return sums;
  }

#if defined(__CUDACC__)
  /// Called by all threads of a block. Each thread returns the sums.
  template <class Entry>
  __device__ static OrderedSums accumulate_by_block(std::uint32_t entries, const Entry& entry) {
    constexpr std::uint32_t tile = 128, banks_apart = 1;
    __shared__ Real staged[3 * vectors][tile + banks_apart];
    __shared__ Real total[3 * count];
    for (std::uint32_t c = threadIdx.x; c < 3 * count; c += blockDim.x) total[c] = 0;
    for (std::uint32_t from = 0; from < entries; from += tile) {
      const std::uint32_t here = min(tile, entries - from);
      for (std::uint32_t k = threadIdx.x; k < here; k += blockDim.x) {
        Vector3<Real> vector[vectors];
        entry(from + k, vector);
        for (int v = 0; v < vectors; ++v)
          for (int axis = 0; axis < 3; ++axis) staged[3 * v + axis][k] = vector[v][axis];
      }
      __syncthreads();
      for (std::uint32_t c = threadIdx.x; c < 3 * count; c += blockDim.x) {
        Real sum = total[c];
        for (std::uint32_t k = 0; k < here; ++k)
          for (int v = 0; v < vectors; ++v)
            if (sum_of_vector(v) == static_cast<int>(c / 3)) sum += staged[3 * v + c % 3][k];
        total[c] = sum;
      }
      __syncthreads();
    }
    OrderedSums sums;
    for (int c = 0; c < 3 * count; ++c) sums.sum[c / 3][c % 3] = total[c];
    __syncthreads();  // total may be overwritten from here on
    return sums;
  }
#endif
};

}  // namespace collidoscope
