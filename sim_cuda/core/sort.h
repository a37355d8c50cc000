#pragma once
// Stable sort of (key, value) by unsigned keys: CUB's radix sort on a GPU (with its own launch shape), a
// parallel comparison sort on the CPU.

#include <cstddef>
#include <cstdint>

#include "sim_cuda/core/executor.h"

namespace collidoscope {

/// Bytes of temporary memory for up to `count` records.
template <class Key>
std::size_t sort_temporary_bytes(Executor& executor, std::int64_t count, int key_bits);

/// Sorts by the lowest `key_bits` bits of the keys. Stable. Inputs are not modified. Inputs and outputs must
/// not overlap. Key: std::uint8_t, uint32_t or uint64_t. count < 2^31.
template <class Key>
void sort_by_key(Executor& executor, const char* stage, std::int64_t count, int key_bits, const Key* keys,
                 Key* sorted_keys, const std::uint32_t* values, std::uint32_t* sorted_values, void* temporary,
                 std::size_t temporary_bytes);

}  // namespace collidoscope
