#include "sim_cuda/core/sort.h"

#include <utility>

#if defined(__CUDACC__)
#include <cub/device/device_radix_sort.cuh>
#endif

namespace collidoscope {

namespace {

/// Counting sort on one thread: faster than a comparison sort on several.
void sort_by_counting(std::int64_t count, int key_bits, const std::uint8_t* keys, std::uint8_t* sorted_keys,
                      const std::uint32_t* values, std::uint32_t* sorted_values) {
  std::int64_t next[256] = {};  // by key: the place of its next record
  const auto key_of = [&](std::int64_t i) { return keys[i] & ((1u << key_bits) - 1); };
  for (std::int64_t i = 0; i < count; ++i) ++next[key_of(i)];
  std::int64_t before = 0;
  for (std::int64_t& place : next) before += std::exchange(place, before);
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t place = next[key_of(i)]++;
    sorted_keys[place] = keys[i];
    sorted_values[place] = values[i];
  }
}

}  // namespace

template <class Key>
std::size_t sort_temporary_bytes([[maybe_unused]] Executor& executor, std::int64_t count,
                                 [[maybe_unused]] int key_bits) {
#if defined(__CUDACC__)
  if (executor.on_device()) {
    std::size_t bytes = 0;
    const Key* keys = nullptr;
    const std::uint32_t* values = nullptr;
    check(cub::DeviceRadixSort::SortPairs(nullptr, bytes, keys, static_cast<Key*>(nullptr), values,
                                          static_cast<std::uint32_t*>(nullptr), static_cast<int>(count), 0,
                                          key_bits),
          "query the workspace size of a sort");
    return bytes;
  }
#endif
  return sizeof(Key) == 1 ? 0 : static_cast<std::size_t>(count) * sizeof(ThreadTeam::KeyedIndex);
}

template <class Key>
void sort_by_key(Executor& executor, const char* stage, std::int64_t count, int key_bits, const Key* keys,
                 Key* sorted_keys, const std::uint32_t* values, std::uint32_t* sorted_values, void* temporary,
                 [[maybe_unused]] std::size_t temporary_bytes) {
  if (count == 0) return;
  executor.begin_stage(stage, true);
#if defined(__CUDACC__)
  if (executor.on_device())
    return check(
        cub::DeviceRadixSort::SortPairs(temporary, temporary_bytes, keys, sorted_keys, values, sorted_values,
                                        static_cast<int>(count), 0, key_bits, executor.stream()),
        "sort " + std::to_string(count) + " keys");
#endif
  executor.count_launches(1);
  if constexpr (sizeof(Key) == 1)
    return sort_by_counting(count, key_bits, keys, sorted_keys, values, sorted_values);
  auto* records = static_cast<ThreadTeam::KeyedIndex*>(temporary);
  const std::uint64_t mask = key_bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << key_bits) - 1;
  for (std::int64_t i = 0; i < count; ++i) records[i] = {keys[i] & mask, static_cast<std::uint32_t>(i)};
  executor.throw_if_cancelled();
  executor.team().sort(records, count);
  executor.throw_if_cancelled();
  for (std::int64_t i = 0; i < count; ++i) {
    sorted_keys[i] = keys[records[i].index];
    sorted_values[i] = values[records[i].index];
  }
}

#define INSTANTIATE(Key)                                                                      \
  template std::size_t sort_temporary_bytes<Key>(Executor&, std::int64_t, int);               \
  template void sort_by_key<Key>(Executor&, const char*, std::int64_t, int, const Key*, Key*, \
                                 const std::uint32_t*, std::uint32_t*, void*, std::size_t);
INSTANTIATE(std::uint8_t)
INSTANTIATE(std::uint32_t)
INSTANTIATE(std::uint64_t)
#undef INSTANTIATE

}  // namespace collidoscope
