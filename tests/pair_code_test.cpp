// Tests the numbering of pairs: bijective, and exact where a float is not.
#include "sim_cuda/broad_phase/pair_code.h"

#include <gtest/gtest.h>
#include "tests/random.h"

namespace collidoscope {
namespace {

TEST(PairCode, NumbersEveryPairOnce) {
  std::uint64_t number = 0;
  for (std::uint32_t b = 1; b < 1500; ++b)
    for (std::uint32_t a = 0; a < b; ++a, ++number) {
      const Pair pair = decode_pair(number);
      ASSERT_TRUE(pair.a == a && pair.b == b) << number << " gives " << pair.a << ' ' << pair.b;
    }
  EXPECT_EQ(number, pair_count(1500));
}

TEST(PairCode, IsExactWhereAFloatIsNot) {
  Random random(1);
  const auto expect = [](std::uint32_t a, std::uint32_t b) {
    const Pair pair = decode_pair(pair_count(b) + a);
    EXPECT_TRUE(pair.a == a && pair.b == b) << a << ' ' << b << " gives " << pair.a << ' ' << pair.b;
  };
  for (int k = 0; k < 20000; ++k) {
    const std::uint32_t b = 1 + (random() >> 1) % (1u << (1 + random() % 31));  // up to 2^31
    expect(0, b);
    expect(b - 1, b);
    expect(random() % b, b);
  }
  expect((1u << 31) - 2, (1u << 31) - 1);
}

TEST(PairCode, FewThingsHaveFewPairs) {
  EXPECT_EQ(pair_count(0), 0u);
  EXPECT_EQ(pair_count(1), 0u);
  EXPECT_EQ(pair_count(2), 1u);
  EXPECT_EQ(pair_count(1u << 27), 9007199187632128u);
}

}  // namespace
}  // namespace collidoscope
