// Tests the grid for overlap queries of spheres against a comparison of all pairs.
#include "sim_cuda/scene/sphere_grid.h"

#include <gtest/gtest.h>

#include <random>

namespace collidoscope {
namespace {

TEST(SphereGrid, AgreesWithAllAgainstAll) {
  std::mt19937 random(1);
  for (const double largest : {0.01, 0.5, 3.0, 20.0}) {
    std::uniform_real_distribution<double> place(-12, 12), radius(0, largest), any(0, 8);
    SphereGrid grid({-10, -10, -10}, {10, 10, 10}, largest, 200);
    std::vector<std::pair<Vector3d, double>> spheres;
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vector3d center(place(random), place(random), place(random));
      const double r = radius(random);
      bool expected = false;
      for (const auto& [other, other_radius] : spheres) {
        expected |= (other - center).squaredNorm() <= (r + other_radius) * (r + other_radius) * (1 + 1e-6);
      }
      ASSERT_EQ(grid.overlaps(center, r), expected) << i;
      hits += expected;
      if (expected && i % 7 != 0) continue;
      const double inserted = i % 50 == 0 ? any(random) : r;  // some exceed the cell size
      grid.insert(center, inserted);
      spheres.emplace_back(center, inserted);
    }
    EXPECT_GT(hits, 0);
  }
}

TEST(SphereGrid, TouchingCounts) {
  SphereGrid grid({0, 0, 0}, {10, 10, 10}, 1, 2);
  grid.insert({5, 5, 5}, 1);
  EXPECT_TRUE(grid.overlaps({7, 5, 5}, 1));
  EXPECT_TRUE(grid.overlaps({7 + 5e-7, 5, 5}, 1));  // within the resolution of a float
  EXPECT_FALSE(grid.overlaps({7 + 5e-6, 5, 5}, 1));
}

}  // namespace
}  // namespace collidoscope
