#pragma once
// A radix sort whose every launch is shared by exactly B x T threads, after Harada & Howes 2011
// ("Introduction to GPU Radix Sort"), whom the paper follows: four bits a pass; each thread counts the digits
// of its own range of the keys, the counts are summed, and each thread puts its range where they say. So
// its cost over (B, T) can be compared with the paper's; a library's sort, which picks its own shape, is
// faster.

#include <cstddef>
#include <cstdint>

#include "sim_cuda/core/executor.h"

namespace collidoscope {

/// Bytes of temporary memory that radix_sort() needs for `count` records, whatever (B, T).
/// 64 a record up to 65,536 of them.
std::size_t radix_sort_temporary_bytes(std::int64_t count);

/// Sorts (key, value) in place by the lowest `key_bits` bits of the keys; equal keys keep their order. The
/// spare arrays are as long, overlap nothing, and hold no meaning afterwards. Key: std::uint32_t or uint64_t.
/// count < 2^31. All B x T threads share the records, as far as there are records, up to 65,536 threads;
/// beyond that, no thread takes fewer than 16. Where the shape is "auto", no thread takes fewer than 16
/// either.
template <class Key>
void radix_sort(Executor& executor, const char* stage, std::int64_t count, int key_bits, Key* keys,
                std::uint32_t* values, Key* spare_keys, std::uint32_t* spare_values, void* temporary);

}  // namespace collidoscope
