// Tests Morton keys against a bit-by-bit definition, and at the border of the extent.
#include "sim_cuda/broad_phase/morton.h"

#include <gtest/gtest.h>
#include "tests/random.h"

namespace collidoscope {
namespace {

/// Interleaves bit by bit, by the definition.
std::uint64_t interleave(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint64_t key = 0;
  for (int bit = 0; bit < 21; ++bit)
    key |= (std::uint64_t{x >> bit & 1} << (3 * bit + 2)) | (std::uint64_t{y >> bit & 1} << (3 * bit + 1)) |
           (std::uint64_t{z >> bit & 1} << (3 * bit));
  return key;
}

TEST(Morton, InterleavesBits) {
  Random random(1);
  for (int k = 0; k < 10000; ++k) {
    const std::uint32_t x = random() >> 11, y = random() >> 11, z = random() >> 11;
    EXPECT_EQ(morton(x, y, z), interleave(x, y, z));
  }
  EXPECT_EQ(morton((1u << 21) - 1, (1u << 21) - 1, (1u << 21) - 1), (std::uint64_t{1} << 63) - 1);
}

Aabb point(float x, float y, float z) { return {Vector3f(x, y, z), Vector3f(x, y, z)}; }

TEST(Morton, KeysSpanTheExtentAndStopAtItsBorder) {
  const Aabb extent{Vector3f(-1, 0, 10), Vector3f(1, 100, 10)};  // flat in z
  EXPECT_EQ(morton_key<std::uint32_t>(point(-1, 0, 10), extent), 0u);
  EXPECT_EQ(morton_key<std::uint32_t>(point(1, 100, 10), extent), morton(1023, 1023, 0));
  EXPECT_EQ(morton_key<std::uint32_t>(point(1e9f, 1e9f, 1e9f), extent), morton(1023, 1023, 0));
  EXPECT_EQ(morton_key<std::uint32_t>(point(0, 50, 10), extent), morton(512, 512, 0));
  EXPECT_EQ(morton_key<std::uint64_t>(point(0, 50, 10), extent), morton(1u << 20, 1u << 20, 0));
  EXPECT_EQ(morton_key<std::uint32_t>(Aabb::empty(), extent), 0u);
}

}  // namespace
}  // namespace collidoscope
