// Tests the sort and the prefix sum on each executor against the standard library, at every launch shape.
#include "sim_cuda/core/sort.h"

#include <algorithm>
#include <numeric>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/radix_sort.h"
#include "sim_cuda/core/scan.h"
#include "sim_cuda/core/segment_sort.h"
#include "tests/executors.h"
#include "tests/random.h"

namespace collidoscope {
namespace {

class Sort : public OnEachExecutor {
 protected:
  /// Sorts on the executor and by std::stable_sort. Few distinct keys, so that a lack of stability shows.
  template <class Key>
  void check(std::size_t count, int key_bits, std::uint64_t distinct) {
    Executor executor(options());
    std::mt19937_64 random(count + static_cast<std::size_t>(key_bits));
    std::vector<Key> keys(count);
    for (Key& key : keys) key = static_cast<Key>((random() % distinct) * 0x9e3779b97f4a7c15u >> 1);
    if (key_bits < 64)
      for (Key& key : keys) key = static_cast<Key>(key & ((Key{1} << (key_bits % 64)) - 1));
    std::vector<std::uint32_t> values(count);
    std::iota(values.begin(), values.end(), 0u);

    Buffer<Key> in(executor, "keys"), out(executor, "sorted keys");
    Buffer<std::uint32_t> value_in(executor, "values"), value_out(executor, "sorted values");
    Buffer<std::byte> temporary(executor, "workspace");
    in.upload(keys);
    value_in.upload(values);
    out.resize_discarding(count);
    value_out.resize_discarding(count);
    const auto n = static_cast<std::int64_t>(count);
    temporary.resize_discarding(sort_temporary_bytes<Key>(executor, n, key_bits));
    sort_by_key<Key>(executor, "sort", n, key_bits, in.data(), out.data(), value_in.data(), value_out.data(),
                     temporary.data(), temporary.bytes());
    executor.synchronize();

    std::stable_sort(values.begin(), values.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
    EXPECT_EQ(value_out.download(), values);
    EXPECT_EQ(in.download(), keys);
    std::sort(keys.begin(), keys.end());
    EXPECT_EQ(out.download(), keys);
  }

  template <class Key>
  void check_radix(LaunchShape shape, LaneOrder order, std::size_t count, int key_bits,
                   std::uint64_t distinct) {
    RunOptions o = options();
    o.shape = shape;
    o.lane_order = order;
    Executor executor(o);
    std::mt19937_64 random(count);
    std::vector<Key> keys(count);
    for (Key& key : keys)
      key = static_cast<Key>((random() % distinct) * 0x9e3779b97f4a7c15u) & ((Key{1} << key_bits) - 1);
    std::vector<std::uint32_t> values(count);
    std::iota(values.begin(), values.end(), 0u);

    Buffer<Key> in_place(executor, "keys"), spare(executor, "spare keys");
    Buffer<std::uint32_t> value(executor, "values"), spare_value(executor, "spare values");
    Buffer<std::byte> temporary(executor, "workspace");
    in_place.upload(keys);
    value.upload(values);
    spare.resize_discarding(count);
    spare_value.resize_discarding(count);
    const auto n = static_cast<std::int64_t>(count);
    temporary.resize_discarding(radix_sort_temporary_bytes(n));
    radix_sort(executor, "sort", n, key_bits, in_place.data(), value.data(), spare.data(), spare_value.data(),
               temporary.data());
    executor.synchronize();

    std::stable_sort(values.begin(), values.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
    EXPECT_EQ(value.download(), values) << shape.blocks << " x " << shape.threads << ", " << count;
    std::sort(keys.begin(), keys.end());
    EXPECT_EQ(in_place.download(), keys);
  }
};
ON_EACH_EXECUTOR(Sort);

TEST_P(Sort, IsStableForEveryKindOfKey) {
  for (const std::size_t count : {0u, 1u, 2u, 255u, 256u, 4097u, 100000u})
    for (const std::uint64_t distinct : {std::uint64_t{1}, std::uint64_t{7}, std::uint64_t{1} << 60}) {
      check<std::uint8_t>(count, 6, std::min<std::uint64_t>(distinct, 35));
      check<std::uint32_t>(count, 30, distinct);
      check<std::uint64_t>(count, 63, distinct);
    }
}

/// Covers (B, T), the lane order, and lengths near the minimum per lane and the group size of the sums.
TEST_P(Sort, ByRadixIsTheSameAtEveryLaunchShape) {
#ifdef WITH_SANITIZER  // any shape with several lanes and threads shows a race or a wrong index
  const std::vector<LaunchShape> shapes{{3, 37}, {0, 0}};
#else
  const std::vector<LaunchShape> shapes{{1, 1}, {2, 4}, {3, 37}, {16, 16}, {8, 64}, {64, 1024}, {0, 0}};
#endif
  for (const LaunchShape shape : shapes)
    for (const LaneOrder order : {LaneOrder::contiguous, LaneOrder::strided, LaneOrder::shuffled})
      for (const std::size_t count : {0u, 1u, 2u, 15u, 16u, 17u, 511u, 512u, 513u, 20000u}) {
        if (GetParam() == ExecutorKind::cuda && order != LaneOrder::contiguous) continue;
        for (const std::uint64_t distinct : {std::uint64_t{1}, std::uint64_t{7}, std::uint64_t{1} << 60}) {
          check_radix<std::uint32_t>(shape, order, count, 30, distinct);
          check_radix<std::uint64_t>(shape, order, count, 63, distinct);
        }
      }
}

class Scan : public OnEachExecutor {};
ON_EACH_EXECUTOR(Scan);

TEST_P(Scan, SumsCounts) {
  Executor executor(options());
  for (const std::size_t count : {0u, 1u, 3u, 1000u, 65537u}) {
    std::vector<std::uint32_t> counts(count + 1);
    Random random(7);
    for (auto& c : counts) c = random();  // the sum of 65537 of them exceeds 2^32
    Buffer<std::uint32_t> in(executor, "counts");
    Buffer<std::uint32_t> out(executor, "offsets");
    Buffer<std::byte> temporary(executor, "workspace");
    in.upload(counts);
    out.resize_discarding(count + 1);
    temporary.resize_discarding(scan_temporary_bytes(executor, static_cast<std::int64_t>(count)));
    exclusive_scan(executor, "scan", static_cast<std::int64_t>(count), in.data(), out.data(),
                   temporary.data(), temporary.bytes());
    executor.synchronize();
    std::vector<std::uint32_t> expected(count + 1, 0);
    for (std::size_t i = 0; i < count; ++i) expected[i + 1] = expected[i] + counts[i];
    EXPECT_EQ(out.download(), expected);
  }
}

TEST(SegmentSort, AgreesWithStdSort) {
  Random random(3);
  for (int count = 0; count < 200; ++count)
    for (const std::uint32_t distinct : {2u, 1000u, 4000000000u}) {
      std::vector<std::uint32_t> values(static_cast<std::size_t>(count));
      for (auto& v : values) v = random() % distinct;
      std::vector<std::uint32_t> expected = values;
      std::sort(expected.begin(), expected.end());
      sort_segment(values.data(), count);
      EXPECT_EQ(values, expected);
    }
}

}  // namespace
}  // namespace collidoscope
