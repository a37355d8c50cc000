#pragma once
// Block-wide operations on one long list, for any block size T (CUB's block collectives need it at compile
// time). All threads of the block must call each of them.

#include <cstdint>

namespace collidoscope {

/// Longer lists are processed by a block, because one thread would take longer than a block with its
/// barriers.
inline constexpr std::uint32_t large_list_size = 256;

#if defined(__CUDACC__)

/// Block-wide running count of selected threads, in thread order and over several calls (stream compaction).
class BlockRanks {
 public:
  /// Number of selected threads before this one, in this call and all earlier calls.
  __device__ std::uint32_t rank(bool selected) {
    __shared__ std::uint32_t in_warp[32];
    const std::uint32_t warp = threadIdx.x / 32, lane = threadIdx.x % 32, warps = (blockDim.x + 31) / 32;
    const std::uint32_t lanes = min(32u, blockDim.x - 32 * warp);
    const std::uint32_t votes = __ballot_sync(lanes == 32 ? ~0u : (1u << lanes) - 1, selected);
    if (lane == 0) in_warp[warp] = static_cast<std::uint32_t>(__popc(votes));
    __syncthreads();
    std::uint32_t before = total_;
    for (std::uint32_t w = 0; w < warps; ++w) {
      if (w < warp) before += in_warp[w];
      total_ += in_warp[w];
    }
    __syncthreads();
    return before + static_cast<std::uint32_t>(__popc(votes & ((1u << lane) - 1)));
  }
  __device__ std::uint32_t total() const { return total_; }

 private:
  std::uint32_t total_ = 0;
};

#endif

}  // namespace collidoscope
