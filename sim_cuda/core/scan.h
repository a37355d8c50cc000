#pragma once
// Exclusive prefix sums of counts: CUB on a GPU (with its own launch shape), one sequential pass on the CPU.
// Integers, so the result does not depend on the order of additions.

#include <cstddef>
#include <cstdint>

#include "sim_cuda/core/executor.h"

namespace collidoscope {

std::size_t scan_temporary_bytes(Executor& executor, std::int64_t count);

/// offsets[i] = counts[0] + ... + counts[i-1] for i in 0 .. count; offsets[count] is the total. Both arrays
/// have count + 1 elements; the value of counts[count] is ignored. Sums wrap at 2^32. A caller with larger
/// totals must detect the wrap by other means (broad_phase/pair_sink.h).
void exclusive_scan(Executor& executor, const char* stage, std::int64_t count, const std::uint32_t* counts,
                    std::uint32_t* offsets, void* temporary, std::size_t temporary_bytes);

}  // namespace collidoscope
