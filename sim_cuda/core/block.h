#pragma once
// What the threads of a block on a GPU do together with one long list, whatever T is (CUB's collectives want
// it at compile time). All of them call each of these.

#include <cstdint>

namespace collidoscope {

/// A list of more entries than this keeps one thread busy for longer than a block needs to gather.
inline constexpr std::uint32_t large_list_size = 256;

#if defined(__CUDACC__)

/// Numbers those who say yes in the order of the threads, call after call.
class BlockRanks {
 public:
  /// How many said yes before this thread, in this call and those before.
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
