// Tests the comparison of pictures against known values and the end points of the perceptual metric. Golden
// tests depend on it.
#include "headless/compare.h"

#include <gtest/gtest.h>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

Image plain(int width, int height, int r, int g, int b) {
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i)
    for (int c : {r, g, b, 255}) image.rgba.push_back(static_cast<std::uint8_t>(c));
  return image;
}

Image with_square(Image image, int from, int size, int value) {
  for (int y = from; y < from + size; ++y)
    for (int x = from; x < from + size; ++x)
      for (int c = 0; c < 3; ++c)
        image.rgba[static_cast<std::size_t>(4 * (y * image.width + x) + c)] =
            static_cast<std::uint8_t>(value);
  return image;
}

TEST(Compare, EqualPicturesDoNotDiffer) {
  const Image image = with_square(plain(64, 48, 40, 90, 200), 10, 20, 230);
  const ImageDifference d = compare_images(image, image);
  EXPECT_EQ(d.max_channel, 0);
  EXPECT_EQ(d.share_over_5, 0);
  EXPECT_EQ(d.perceptual_mean, 0);
}

TEST(Compare, CountsPixelsAndTheLargestStep) {
  const Image a = plain(50, 40, 100, 100, 100);
  EXPECT_EQ(compare_images(a, with_square(a, 10, 10, 105)).share_over_5, 0);
  const ImageDifference d = compare_images(a, with_square(a, 10, 10, 106));
  EXPECT_EQ(d.max_channel, 6);
  EXPECT_DOUBLE_EQ(d.share_over_5, 100.0 / 2000);
}

TEST(Compare, ThePerceptualMeanHasItsKnownEnds) {
  // FLIP: black against white is slightly below 1; green against blue is 1 by definition.
  EXPECT_NEAR(compare_images(plain(40, 40, 0, 0, 0), plain(40, 40, 255, 255, 255)).perceptual_mean, 0.98,
              0.02);
  EXPECT_NEAR(compare_images(plain(40, 40, 0, 255, 0), plain(40, 40, 0, 0, 255)).perceptual_mean, 1, 0.001);
}

TEST(Compare, ThePerceptualMeanGrowsWithTheDifferenceAndIsSymmetric) {
  const Image a = plain(60, 60, 90, 100, 120);
  double before = 0;
  for (int value : {104, 120, 160, 250}) {
    const Image b = with_square(a, 20, 20, value);
    const double mean = compare_images(a, b).perceptual_mean;
    EXPECT_GT(mean, before);
    EXPECT_NEAR(mean, compare_images(b, a).perceptual_mean, 1e-6);
    before = mean;
  }
}

TEST(Compare, FineNoiseMattersLessThanAPatch) {
  // One pixel in nine against a solid patch of equal area: the metric blurs the fine noise.
  const Image a = plain(90, 90, 128, 128, 128);
  Image noise = a;
  for (int y = 0; y < 90; y += 3)
    for (int x = 0; x < 90; x += 3)
      for (int c = 0; c < 3; ++c) noise.rgba[static_cast<std::size_t>(4 * (y * 90 + x) + c)] = 136;
  const ImageDifference fine = compare_images(a, noise),
                        patch = compare_images(a, with_square(a, 30, 30, 136));
  EXPECT_DOUBLE_EQ(fine.share_over_5, patch.share_over_5);
  EXPECT_LT(compare_images(a, noise).perceptual_mean * 900, patch.perceptual_mean * 8100 * 9);
}

TEST(Compare, RefusesTwoSizes) {
  EXPECT_THROW(compare_images(plain(4, 4, 0, 0, 0), plain(4, 5, 0, 0, 0)), InputError);
}

}  // namespace
}  // namespace collidoscope
