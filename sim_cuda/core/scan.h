#pragma once
// Exclusive prefix sums of counts: CUB's on a GPU (its own launch shape), one pass on the CPU. Integer, so
// exact in any order.

#include <cstddef>
#include <cstdint>

#include "sim_cuda/core/executor.h"

namespace collidoscope {

std::size_t scan_temporary_bytes(Executor& executor, std::int64_t count);

/// offsets[i] = counts[0] + ... + counts[i-1] for i in 0 .. count, so offsets[count] is the total. `counts`
/// has count + 1 readable elements, the last of which does not matter; `offsets` has count + 1. Sums wrap at
/// 2^32: where the total may be larger, the caller knows it by other means (pair_sink.h).
void exclusive_scan(Executor& executor, const char* stage, std::int64_t count, const std::uint32_t* counts,
                    std::uint32_t* offsets, void* temporary, std::size_t temporary_bytes);

}  // namespace collidoscope
