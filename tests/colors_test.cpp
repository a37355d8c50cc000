#include "viewer/render/colors.h"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(Colors, LevelsDifferFromEachOther) {
  for (int a = 0; a < 8; ++a) {
    for (int b = 0; b < a; ++b) {
      const Rgb x = level_color(a), y = level_color(b);
      EXPECT_GT(std::hypot(x.r - y.r, x.g - y.g, x.b - y.b), 0.2) << a << ' ' << b;
    }
    EXPECT_EQ(level_color(a).r, level_color(a + 8).r);
  }
}

TEST(Colors, StrongerContactsAreLighter) {
  for (int k = 1; k <= 64; ++k)
    EXPECT_GT(luminance(contact_color(k / 64.0)), luminance(contact_color((k - 1) / 64.0))) << k;
  EXPECT_EQ(contact_color(-1).r, contact_color(0).r);
  EXPECT_EQ(contact_color(2).g, contact_color(1).g);
}

}  // namespace
}  // namespace collidoscope
