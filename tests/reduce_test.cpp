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

TEST(Reduce, ChunksCoverAllItemsOnce) {
  std::vector<double> ones(1000, 1.0);
  std::vector<Sum> sums(4);
  for (int chunk = 0; chunk < 4; ++chunk)
    ReduceChunk<Sum, LoadValue>{{ones.data()}, 1000, sums.data()}(chunk);
  EXPECT_EQ(sums[0].value + sums[1].value + sums[2].value, 768.0);
  EXPECT_EQ(sums[3].value, 232.0);
  EXPECT_EQ(reduce_scratch_size(1), 1u);
  EXPECT_EQ(reduce_scratch_size(257), 1u + 2u + 1u);
}

}  // namespace
}  // namespace collidoscope
