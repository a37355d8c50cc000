#include "sim_cuda/core/radix_sort.h"

#include <algorithm>
#include <utility>

namespace collidoscope {

namespace {

constexpr int digit_bits = 4;
constexpr std::uint32_t digits = 1u << digit_bits;
// With this number of records per lane, the table of counters is no longer than the keys.
constexpr std::int64_t min_records_per_lane = 16;
// Up to this number of threads, each of the B x T threads may have a single record.
constexpr std::int64_t one_record_lanes = 65'536;

/// A lane's records are contiguous, so that the sort is stable.
struct LaneRanges {
  std::int64_t count, lanes;
  SIM_HD std::int64_t begin(int lane) const { return count * lane / lanes; }
};

/// The table is digit-major: the counts of all lanes for digit 0, then digit 1, and so on. Its exclusive scan
/// gives the output positions.
template <class Key>
struct CountDigits {
  LaneRanges ranges;
  const Key* keys;
  int shift;
  std::uint32_t* table;
  SIM_HD void operator()(int lane) const {
    std::uint32_t counts[digits] = {};
    for (std::int64_t i = ranges.begin(lane); i < ranges.begin(lane + 1); ++i)
      ++counts[(keys[i] >> shift) & (digits - 1)];
    for (std::uint32_t d = 0; d < digits; ++d) table[d * ranges.lanes + lane] = counts[d];
  }
};

template <class Key>
struct ScatterByDigit {
  LaneRanges ranges;
  const Key* keys;
  const std::uint32_t* values;
  int shift;
  const std::uint32_t* table;
  Key* out_keys;
  std::uint32_t* out_values;
  SIM_HD void operator()(int lane) const {
    std::uint32_t next[digits];
    for (std::uint32_t d = 0; d < digits; ++d) next[d] = table[d * ranges.lanes + lane];
    for (std::int64_t i = ranges.begin(lane); i < ranges.begin(lane + 1); ++i) {
      const std::uint32_t place = next[(keys[i] >> shift) & (digits - 1)]++;
      out_keys[place] = keys[i];
      out_values[place] = values[i];
    }
  }
};

// Exclusive scan over a tree of groups, in (B, T) threads: the up-sweep sums groups, the down-sweep adds the
// sums of preceding groups.
constexpr std::int64_t group = 32;
constexpr std::int64_t groups_of(std::int64_t count) { return (count + group - 1) / group; }

struct SumGroup {
  const std::uint32_t* values;
  std::int64_t count;
  std::uint32_t* sums;
  SIM_HD void operator()(int g) const {
    std::uint32_t sum = 0;
    for (std::int64_t i = g * group; i < (g + 1) * group && i < count; ++i) sum += values[i];
    sums[g] = sum;
  }
};

struct ScanGroup {
  std::uint32_t* values;
  std::int64_t count;
  const std::uint32_t* before;  ///< sum of preceding groups, by group; nullptr if there is one group
  SIM_HD void operator()(int g) const {
    std::uint32_t sum = before == nullptr ? 0 : before[g];
    for (std::int64_t i = g * group; i < (g + 1) * group && i < count; ++i) {
      const std::uint32_t value = values[i];
      values[i] = sum;
      sum += value;
    }
  }
};

/// Exclusive scan of `values` in place. `sums` has room for the group sums of all levels.
void exclusive_scan_in_place(Executor& executor, const char* stage, std::uint32_t* values, std::int64_t count,
                             std::uint32_t* sums) {
  const std::int64_t groups = groups_of(count);
  if (groups > 1) {
    executor.run(stage, groups, SumGroup{values, count, sums});
    exclusive_scan_in_place(executor, stage, sums, groups, sums + groups);
  }
  executor.run(stage, groups, ScanGroup{values, count, groups > 1 ? sums : nullptr});
}

std::int64_t default_lanes(std::int64_t count) {
  return (count + min_records_per_lane - 1) / min_records_per_lane;
}
std::int64_t max_lanes(std::int64_t count) {
  return std::max(default_lanes(count), std::min(count, one_record_lanes));
}

}  // namespace

std::size_t radix_sort_temporary_bytes(std::int64_t count) {
  std::int64_t words = 0;
  for (std::int64_t level = digits * max_lanes(count); level > 0; level = groups_of(level)) {
    words += level;
    if (level == 1) break;
  }
  return static_cast<std::size_t>(words) * sizeof(std::uint32_t);
}

template <class Key>
void radix_sort(Executor& executor, const char* stage, std::int64_t count, int key_bits, Key* keys,
                std::uint32_t* values, Key* spare_keys, std::uint32_t* spare_values, void* temporary) {
  if (count == 0) return;
  const LaunchShape shape = executor.options().shape;
  const std::int64_t requested = std::int64_t{shape.blocks} * shape.threads;
  const LaneRanges ranges{count,
                          requested > 0 ? std::min(requested, max_lanes(count)) : default_lanes(count)};
  auto* table = static_cast<std::uint32_t*>(temporary);
  const std::int64_t entries = digits * ranges.lanes;
  // With an even number of passes the result ends in the input arrays.
  for (int shift = 0; shift < key_bits || shift % (2 * digit_bits) != 0; shift += digit_bits) {
    executor.run(stage, ranges.lanes, CountDigits<Key>{ranges, keys, shift, table});
    exclusive_scan_in_place(executor, stage, table, entries, table + entries);
    executor.run(stage, ranges.lanes,
                 ScatterByDigit<Key>{ranges, keys, values, shift, table, spare_keys, spare_values});
    std::swap(keys, spare_keys);
    std::swap(values, spare_values);
  }
}

template void radix_sort(Executor&, const char*, std::int64_t, int, std::uint32_t*, std::uint32_t*,
                         std::uint32_t*, std::uint32_t*, void*);
template void radix_sort(Executor&, const char*, std::int64_t, int, std::uint64_t*, std::uint32_t*,
                         std::uint64_t*, std::uint32_t*, void*);

}  // namespace collidoscope
