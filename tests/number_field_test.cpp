// Tests the parsing of numbers typed into fields. A number is accepted in full and within its range, or
// refused with the range.

#include "ui/number_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

template <class Number>
std::string fault_of(const std::string& text, const NumberRange<Number>& range, Number before) {
  Number value = before;
  const std::string fault = read_number(text, range, value);
  EXPECT_TRUE(fault.empty() || value == before) << text << ": what is refused changes nothing";
  EXPECT_TRUE(!fault.empty() || (value >= range.low && value <= range.high) ||
              (range.zero_is_auto && value == 0))
      << text;
  return fault;
}

TEST(NumberField, NothingWraps) {
  const NumberRange<std::int64_t> blocks{1, limits::max_blocks, "", true};
  for (const char* text :
       {"99999999999", "2147483648", "4294967297", "99999999999999999999", "-1", "-99999999999"})
    EXPECT_EQ(
        fault_of<std::int64_t>(text, blocks, 7),
        std::string(text) + " is out of range; allowed: a whole number from 1 to 2,147,483,647, or auto");
  const NumberRange<std::uint64_t> seeds{0, std::numeric_limits<std::uint64_t>::max()};
  EXPECT_THAT(fault_of<std::uint64_t>("18446744073709551616", seeds, 1), HasSubstr("is out of range"));
  EXPECT_THAT(fault_of<std::uint64_t>("-1", seeds, 1), HasSubstr("is out of range"));
  EXPECT_EQ(fault_of<std::uint64_t>("18446744073709551615", seeds, 1), "");
}

TEST(NumberField, WhatIsNoNumberIsNamed) {
  const NumberRange<std::int64_t> blocks{1, limits::max_blocks, "", true};
  for (const char* text :
       {"abc", "", "7.5", "7 8", "7e-1", "0x10", "1,2", "12,34,567", "1e", "1e15", "--3", "seven"})
    EXPECT_EQ(fault_of<std::int64_t>(text, blocks, 7),
              "'" + std::string(text) +
                  "' is not a whole number; allowed: a whole number from 1 to 2,147,483,647, or auto");
  const NumberRange<double> rate{limits::min_rate, limits::max_steps_per_second, "Hz"};
  EXPECT_EQ(fault_of<double>("abc", rate, 30.0), "'abc' is not a number; allowed: 0.001 to 1e+06 Hz");
  EXPECT_EQ(fault_of<double>("1e9", rate, 30.0), "1e9 is out of range; allowed: 0.001 to 1e+06 Hz");
  for (const char* text : {"nan", "inf", "-inf", "1e999", "0", "-5", "1000001"})
    EXPECT_THAT(fault_of<double>(text, rate, 30.0), HasSubstr("is out of range")) << text;
  EXPECT_THAT(fault_of<double>("30 kHz", rate, 30.0), HasSubstr("is not a number"));
}

TEST(NumberField, TakesWhatPeopleType) {
  std::int64_t blocks = 7;
  const NumberRange<std::int64_t> automatic{1, limits::max_blocks, "", true};
  EXPECT_EQ(read_number<std::int64_t>(" 12 ", automatic, blocks), "");
  EXPECT_EQ(blocks, 12);
  EXPECT_EQ(read_number<std::int64_t>("+5", automatic, blocks), "");
  EXPECT_EQ(blocks, 5);
  EXPECT_EQ(read_number<std::int64_t>("auto", automatic, blocks), "");
  EXPECT_EQ(blocks, 0);
  EXPECT_NE(read_number<std::int64_t>("auto", {1, 9}, blocks), "");
  double rate = 30;
  const NumberRange<double> hertz{limits::min_rate, limits::max_steps_per_second, "Hz"};
  EXPECT_EQ(read_number<double>("2.5e2 Hz", hertz, rate), "");
  EXPECT_EQ(rate, 250);
  EXPECT_EQ(read_number<double>("60Hz", hertz, rate), "");
  EXPECT_EQ(rate, 60);
}

TEST(NumberField, TakesWhatIsPrinted) {
  std::int64_t bodies = 7;
  const NumberRange<std::int64_t> range{0, limits::max_bodies};
  for (const auto& [text, value] : {std::pair{"134,217,728", 134'217'728},
                                    {"1e3", 1000},
                                    {"2.5e3", 2500},
                                    {"1,000", 1000},
                                    {"12.0", 12},
                                    {"-0", 0}}) {
    EXPECT_EQ(read_number<std::int64_t>(text, range, bodies), "") << text;
    EXPECT_EQ(bodies, value) << text;
  }
  double restitution = 1;
  EXPECT_EQ(read_number<double>("-0", {0, 1}, restitution), "");
  EXPECT_FALSE(std::signbit(restitution));
  double rate = 1;
  EXPECT_EQ(read_number<double>("1e+06 Hz", {1e-3, 1e6, "Hz"}, rate), "");
  EXPECT_EQ(rate, 1e6);
}

}  // namespace
}  // namespace collidoscope
