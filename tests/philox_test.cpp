// Tests the random number generator Philox against the published vectors. Equal numbers on every machine
// depend on it.
#include "sim_cuda/core/philox.h"

#include <gtest/gtest.h>

#include <set>

namespace collidoscope {
namespace {

struct KnownAnswer {
  PhiloxWords counter;
  PhiloxKey key;
  PhiloxWords bits;
};

// The three vectors for philox4x32-10 published with Random123 (tests/kat_vectors): zeros, ones, digits of
// pi.
constexpr KnownAnswer known_answers[] = {
    {{{0, 0, 0, 0}}, {{0, 0}}, {{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}}},
    {{{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}},
     {{0xffffffff, 0xffffffff}},
     {{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}}},
    {{{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}},
     {{0xa4093822, 0x299f31d0}},
     {{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}}},
};

TEST(Philox, KnownAnswers) {
  for (const KnownAnswer& known : known_answers) {
    const PhiloxWords bits = philox4x32(known.counter, known.key);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(bits.w[i], known.bits.w[i]) << i;
  }
}

TEST(Philox, SeedIsTheKeyLowWordFirst) {
  const PhiloxKey key = philox_key(0x299f31d0a4093822u);
  EXPECT_EQ(key.k[0], 0xa4093822u);
  EXPECT_EQ(key.k[1], 0x299f31d0u);
}

TEST(Philox, UnitFloatStaysBelowOne) {
  EXPECT_EQ(unit_float(0), 0.0f);
  EXPECT_EQ(unit_float(0xff), 0.0f);  // the lowest 8 bits are unused
  EXPECT_EQ(unit_float(0x100), 0x1p-24f);
  EXPECT_EQ(unit_float(0x80000000u), 0.5f);
  EXPECT_EQ(unit_float(0xffffffffu), 1 - 0x1p-24f);
}

TEST(Philox, NeighbouringCountersDiffer) {
  std::set<std::uint32_t> seen;
  for (std::uint32_t id = 0; id < 1000; ++id) {
    for (std::uint32_t stream = 0; stream < 3; ++stream) {
      seen.insert(philox4x32({{id, stream, 0, 0}}, philox_key(1)).w[0]);
    }
  }
  EXPECT_GE(seen.size(), 2998u);  // 3000^2 / 2^33 = 0.001 collisions are expected
}

}  // namespace
}  // namespace collidoscope
