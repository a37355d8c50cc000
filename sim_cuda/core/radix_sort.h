#pragma once
// LSD radix sort that launches exactly B x T threads, after Harada & Howes 2011 ("Introduction to GPU Radix
// Sort"), as in the paper. Each pass sorts by four bits: each thread counts the digits of its range, the
// counts are scanned, and each thread scatters its range. Its cost over (B, T) is comparable with the
// paper's. A library sort, which chooses its own launch shape, is faster.

#include <cstddef>
#include <cstdint>

#include "sim_cuda/core/executor.h"

namespace collidoscope {

/// Bytes of temporary memory for `count` records, for any (B, T). 64 bytes per record up to 65,536 records.
std::size_t radix_sort_temporary_bytes(std::int64_t count);

/// Sorts (key, value) in place by the lowest `key_bits` bits of the keys. Stable. Key: std::uint32_t or
/// uint64_t. count < 2^31.
///
/// The spare arrays have the same length, must not overlap the others, and are undefined afterwards.
///
/// All B x T threads share the records, at most one thread per record, up to 65,536 threads. Beyond that, and
/// with an automatic shape, each thread has at least 16 records.
template <class Key>
void radix_sort(Executor& executor, const char* stage, std::int64_t count, int key_bits, Key* keys,
                std::uint32_t* values, Key* spare_keys, std::uint32_t* spare_values, void* temporary);

}  // namespace collidoscope
