// Tests the parsing of flag values: whole numbers, seeds, ranges and vectors. No partial match and no
// overflow may pass.
#include "headless/cli/flag_value.h"

#include <gtest/gtest.h>

#include <limits>

namespace collidoscope {
namespace {

struct Read {
  std::vector<std::string> faults;
  FlagValue of(std::string_view text) { return {"--flag", text, faults}; }
};

TEST(FlagValue, WholeNumbersMatchFully) {
  Read read;
  EXPECT_EQ(read.of("0").whole(0, 10), 0);
  EXPECT_EQ(read.of("10").whole(0, 10), 10);
  EXPECT_EQ(read.of("-3").whole(-5, 5), -3);
  EXPECT_TRUE(read.faults.empty());
  for (const char* bad :
       {"", " 1", "1 ", "+1", "0x1", "1.0", "1e1", "11", "-1", "1,0", "99999999999999999999"})
    EXPECT_FALSE(read.of(bad).whole(0, 10)) << bad;
  EXPECT_EQ(read.faults.size(), 11u);
  EXPECT_EQ(read.faults[0], "--flag: '' is not a whole number from 0 to 10");
}

TEST(FlagValue, SeedsUseAll64Bits) {
  Read read;
  EXPECT_EQ(read.of("18446744073709551615").whole_u64(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_FALSE(read.of("18446744073709551616").whole_u64());
  EXPECT_FALSE(read.of("-1").whole_u64());
}

TEST(FlagValue, NumbersAreFiniteAndInRange) {
  Read read;
  EXPECT_EQ(read.of("0.1").number(0, 1, "s"), 0.1);
  EXPECT_EQ(read.of("1e-3").number(0, 1, "s"), 1e-3);
  EXPECT_TRUE(read.faults.empty());
  for (const char* bad : {"nan", "NaN", "inf", "-inf", "1e999", "infinity", "1.1", "-0.1", "0,1", "1s", ""})
    EXPECT_FALSE(read.of(bad).number(0, 1, "s")) << bad;
  EXPECT_EQ(read.faults.size(), 11u);
}

TEST(FlagValue, VectorsHaveThreeComponents) {
  Read read;
  EXPECT_EQ(read.of("1,-2.5,3e2").vector(1000, "m"), Vector3d(1, -2.5, 300));
  EXPECT_TRUE(read.faults.empty());
  for (const char* bad : {"", "1", "1,2", "1,2,3,4", "1,2,", ",,", "1,2,nan", "1,2,1001", "1, 2,3"})
    EXPECT_FALSE(read.of(bad).vector(1000, "m")) << bad;
  EXPECT_EQ(read.faults.size(), 9u);
}

TEST(FlagValue, ShownTextIsOneShortLine) {
  EXPECT_EQ(shown("a\nb\x1b"), "a?b?");
  EXPECT_EQ(shown(""), "''");
  EXPECT_LT(shown(std::string(100'000, 'x')).size(), 300u);
}

}  // namespace
}  // namespace collidoscope
