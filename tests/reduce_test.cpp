// Tests the reduction tree against a recursive version. The fixed tree makes sums independent of the launch
// shape.
#include "sim_cuda/core/reduce.h"

#include <gtest/gtest.h>

#include <random>

namespace collidoscope {
namespace {

struct Sum {
  double value;
};
Sum combine(Sum a, Sum b) { return {a.value + b.value}; }

struct LoadValue {
  const double* values;
  Sum operator()(std::int64_t i) const { return {values[i]}; }
};

/// The same tree, recursively.
double tree(const double* values, std::int64_t count) {
  if (count == 1) return values[0];
  std::int64_t half = 1;
  while (2 * half < count) half *= 2;
  return tree(values, half) + tree(values + half, count - half);
}

TEST(Reduce, AChunkIsThePairwiseTree) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> spread(-1, 1);
  for (std::int64_t count = 1; count <= reduce_chunk; ++count) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (double& v : values) v = spread(random);
    Sum result{};
    ReduceChunk<Sum, LoadValue>{{values.data()}, count, &result}(0);
    EXPECT_EQ(result.value, tree(values.data(), count)) << count;
  }
}

/// The levels of reduce(), on the host.
double reduced(const std::vector<double>& values) {
  const auto count = static_cast<std::int64_t>(values.size());
  std::int64_t chunks = (count + reduce_chunk - 1) / reduce_chunk;
  std::vector<Sum> sums(static_cast<std::size_t>(chunks));
  for (int chunk = 0; chunk < chunks; ++chunk)
    ReduceChunk<Sum, LoadValue>{{values.data()}, count, sums.data()}(chunk);
  while (chunks > 1) {
    const std::int64_t next = (chunks + reduce_chunk - 1) / reduce_chunk;
    std::vector<Sum> above(static_cast<std::size_t>(next));
    for (int chunk = 0; chunk < next; ++chunk)
      ReduceChunk<Sum, LoadSum<Sum>>{{sums.data()}, chunks, above.data()}(chunk);
    sums = std::move(above);
    chunks = next;
  }
  return sums[0].value;
}

TEST(Reduce, AllLevelsAreOneTreeOfEveryItem) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> spread(-1, 1);
  for (const std::int64_t count : {1, 2, 31, 32, 33, 63, 64, 65, 1000, 1023, 1024, 1025, 4097, 33'000}) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (double& v : values) v = spread(random);
    EXPECT_EQ(reduced(values), tree(values.data(), count)) << count;
    EXPECT_EQ(reduced(std::vector<double>(static_cast<std::size_t>(count), 1)), static_cast<double>(count));
  }
  EXPECT_EQ(reduce_scratch_size(1), 1u);
  EXPECT_EQ(reduce_scratch_size(1025), 1u + 33u + 2u + 1u);
}

}  // namespace
}  // namespace collidoscope
