// Tests the colour maps: monotonic lightness, no jumps, and distinguishable levels. Colours encode values, so
// their order must be visible.
#include "viewer/render/colors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace collidoscope {
namespace {

double luminance(const Rgb& c) {
  return 0.2126 * std::pow(c.r, 2.2) + 0.7152 * std::pow(c.g, 2.2) + 0.0722 * std::pow(c.b, 2.2);
}

TEST(Colors, TheMapsGrowLighterWithoutAStep) {
  for (const auto& map : {color_map(), heat_map()})
    for (std::size_t i = 1; i < 256; ++i) {
      EXPECT_GT(luminance(map[i]), luminance(map[i - 1])) << i;
      EXPECT_LT(luminance(map[i]) - luminance(map[i - 1]), 0.01) << i;
    }
}

TEST(Colors, LevelsGoFromDarkToLight) {
  for (const auto& [first, last] : {std::pair{0, 3}, {2, 4}, {0, 15}, {0, 40}}) {
    for (int level = first + 1; level <= last; ++level)
      EXPECT_GT(luminance(level_color(level, first, last)), luminance(level_color(level - 1, first, last)))
          << level << " of " << first << " to " << last;
    EXPECT_LT(luminance(level_color(first, first, last)), 0.12);
    EXPECT_GT(luminance(level_color(last, first, last)), 0.6);
    EXPECT_EQ(level_color(first - 1, first, last).r, level_color(first, first, last).r);
    EXPECT_EQ(level_color(last + 9, first, last).r, level_color(last, first, last).r);
  }
  for (int a = 2; a <= 6; ++a)  // of up to five levels, neighbours are clearly distinguishable
    for (int b = 2; b < a; ++b) {
      const Rgb x = level_color(a, 2, 6), y = level_color(b, 2, 6);
      EXPECT_GT(std::hypot(x.r - y.r, x.g - y.g, x.b - y.b), 0.2) << a << ' ' << b;
    }
  EXPECT_GT(luminance(level_color(5, 5, 5)), 0.6) << "a level alone";
}

TEST(Colors, StrongerContactsAreLighter) {
  for (int k = 1; k <= 64; ++k)
    EXPECT_GT(luminance(contact_color(k / 64.0)), luminance(contact_color((k - 1) / 64.0))) << k;
  EXPECT_EQ(contact_color(-1).r, contact_color(0).r);
  EXPECT_EQ(contact_color(2).g, contact_color(1).g);
}

}  // namespace
}  // namespace collidoscope
