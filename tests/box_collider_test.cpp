// Tests the generator of the Box Collider against its formulas, brute force and statistics of its random
// numbers. The benchmark scene must be the one of the paper.
#include "sim_cuda/scene/box_collider.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/philox.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/scene/settings_patch.h"

namespace collidoscope {
namespace {

InitialBodies spawned(const BoxCollider& generator, const Box& box = {}) {
  InitialBodies bodies;
  append_box_collider(generator, box, "generators[0]", bodies);
  return bodies;
}

/// The number of overlapping spheres, by comparing all pairs.
int overlaps(const InitialBodies& bodies) {
  int count = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const Vector3f d = bodies.position[i].cast<float>() - bodies.position[j].cast<float>();
      const float reach = static_cast<float>(bodies.radius[i]) + static_cast<float>(bodies.radius[j]);
      count += d.dot(d) <= reach * reach;
    }
  }
  return count;
}

int outside(const InitialBodies& bodies, const Box& box, bool whole_spheres) {
  int count = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double margin = whole_spheres ? bodies.radius[i] : 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double x = bodies.position[i][axis];
      count += !(x - margin >= box.min[axis] && x + margin <= box.max[axis]);
    }
  }
  return count;
}

TEST(BoxCollider, CubeRoots) {
  EXPECT_EQ(newton_cube_root(0), 0);
  EXPECT_EQ(newton_cube_root(1), 1);
  EXPECT_EQ(newton_cube_root(8), 2);
  EXPECT_EQ(newton_cube_root(1e6), 100);
  for (double x = 1e-12; x < 1e40; x *= 3.7) {
    EXPECT_NEAR(newton_cube_root(x) / std::cbrt(x), 1, 5e-16) << x;
  }
}

TEST(BoxCollider, ScaledSideKeepsThirtyPercentFull) {
  EXPECT_EQ(scaled_side(0, 5), 100);
  EXPECT_EQ(scaled_side(2000, 5), 100);  // 2,291 is the largest number that fits in 100 m
  EXPECT_EQ(scaled_side(2291, 5), 100);
  EXPECT_GT(scaled_side(2292, 5), 100);
  const double side = scaled_side(1'000'000, 5);
  EXPECT_NEAR(side, 758.47, 0.01);  // cuberoot(10^6 130.9 / 0.3)
  EXPECT_NEAR(1e6 * std::numbers::pi / 3 * 125 / (side * side * side), 0.3, 1e-7);
  EXPECT_EQ(side, static_cast<float>(side));
}

TEST(BoxCollider, EqualRadiusHasTheMeanVolume) {
  EXPECT_NEAR(equal_radius(5), 5 * std::cbrt(0.25), 2e-7);
  const BoxCollider uniform{.count = 200'000, .variant = Variant::paper};
  double volume = 0;
  for (const double r : spawned(uniform).radius) volume += r * r * r;
  EXPECT_NEAR(volume / 200'000, std::pow(equal_radius(5), 3), 0.2);  // standard error 0.08
  for (const double r : spawned({.count = 10, .variant = Variant::equal}).radius)
    EXPECT_EQ(r, equal_radius(5));
}

TEST(BoxCollider, MostlySmallRadiiFillAsMuchOfTheBox) {
  BoxCollider small{.count = 200'000, .radii = Radii::mostly_small, .variant = Variant::scaled};
  Scene scene;
  scene.box = Box{};
  scene.generators = {small};
  const InitialBodies bodies = initial_bodies(scene);
  const double side = scaled_side(small.count, small.radius_max, small.radii);
  double volume = 0;
  std::size_t below_a_fifth = 0;
  for (const double r : bodies.radius) {
    volume += 4 * std::numbers::pi / 3 * r * r * r;
    below_a_fifth += r < small.radius_max / 5;
    EXPECT_GE(r, small.radius_max / 16);
    EXPECT_LE(r, small.radius_max);
  }
  EXPECT_NEAR(volume / (side * side * side), scaled_fill, 0.003);
  EXPECT_NEAR(static_cast<double>(below_a_fifth) / 200'000, std::cbrt((16.0 / 5 - 1) / 15), 0.005);
  EXPECT_NEAR(equal_radius(5, Radii::mostly_small), 5 * std::cbrt(0.10893), 1e-4);
}

// The whole change besides the physics above is a member and a row of the table of settings.
TEST(BoxCollider, RadiiAreASettingOfFilesFlagsAndChanges) {
  const Scene read = parse_scene(
      R"({"format": "collidoscope-scene", "version": 1, "box": {},
          "generators": [{"kind": "box_collider", "count": 4, "radii": "mostly_small"}]})",
      "s");
  EXPECT_EQ(read.generators[0].radii, Radii::mostly_small);
  EXPECT_THAT(write_scene(read), testing::HasSubstr(R"("radii": "mostly_small")"));
  SettingsPatch patch;
  patch.set<&BoxCollider::radii>(Radii::uniform);
  Scene changed = read;
  apply(patch, changed);
  EXPECT_EQ(initial_bodies(changed).radius,
            initial_bodies(parse_scene(
                               R"({"format": "collidoscope-scene", "version": 1, "box": {},
          "generators": [{"kind": "box_collider", "count": 4}]})",
                               "s"))
                .radius);
}

TEST(BoxCollider, DrawsFollowTheFormula) {
  const BoxCollider generator{.count = 100, .radius_max = 4, .seed = 0x123456789abcdefu, .speed_max = 7};
  const Box box{{-10, 20, 0}, {40, 60, 30}};
  const InitialBodies bodies = spawned(generator, box);
  for (std::uint32_t i = 0; i < 100; ++i) {
    const PhiloxWords r = philox4x32({{i, 0, 0, 0}}, philox_key(generator.seed));
    const PhiloxWords v = philox4x32({{i, 1, 0, 0}}, philox_key(generator.seed));
    const float radius = 4.0f * (1.0f - static_cast<float>(r.w[0] >> 8) * 0x1p-24f);
    EXPECT_EQ(bodies.radius[i], radius);
    for (int axis = 0; axis < 3; ++axis) {
      const auto min = static_cast<float>(box.min[axis]),
                 side = static_cast<float>(box.max[axis] - box.min[axis]);
      EXPECT_EQ(bodies.position[i][axis],
                min + radius + static_cast<float>(r.w[axis + 1] >> 8) * 0x1p-24f * (side - 2 * radius));
      EXPECT_EQ(bodies.velocity[i][axis], 7.0f * (2 * (static_cast<float>(v.w[axis] >> 8) * 0x1p-24f) - 1));
    }
  }
}

TEST(BoxCollider, ABodyIsTheSameForEveryN) {
  const InitialBodies few = spawned({.count = 10, .speed_max = 1}),
                      many = spawned({.count = 1000, .speed_max = 1});
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(few.position[i], many.position[i]);
    EXPECT_EQ(few.radius[i], many.radius[i]);
    EXPECT_EQ(few.velocity[i], many.velocity[i]);
  }
  EXPECT_NE(spawned({.count = 1, .seed = 2}).position[0], few.position[0]);
  EXPECT_NE(spawned({.count = 1, .seed = (std::uint64_t{1} << 32) + 1}).position[0], few.position[0]);
}

TEST(BoxCollider, InsideMeansWholeSpheresToTheLastBit) {
  // Boxes with unusual corners and thin boxes, where rounding could move spheres across a wall.
  for (const Box& box :
       {Box{}, Box{{-0.1, 1e5, -3.3}, {10.1, 100'010.3, 1e4}}, Box{{0.1, 0.1, 0.1}, {10.1, 10.11, 10.3}}}) {
    EXPECT_EQ(outside(spawned({.count = 100'000, .seed = 5}, box), box, true), 0);
  }
}

TEST(BoxCollider, CentresMayLeanOut) {
  const InitialBodies bodies = spawned({.count = 10'000, .spawn = Spawn::centres});
  EXPECT_EQ(outside(bodies, Box{}, false), 0);
  EXPECT_GT(outside(bodies, Box{}, true), 0);
}

TEST(BoxCollider, RadiiAreUniform) {
  int counts[10] = {};
  const InitialBodies bodies = spawned({.count = 100'000});
  for (const double r : bodies.radius) {
    ASSERT_TRUE(r > 0 && r <= 5);
    ++counts[static_cast<int>(std::min(r * 2, 9.999))];
  }
  double chi_squared = 0;
  for (const int count : counts) chi_squared += (count - 1e4) * (count - 1e4) / 1e4;
  EXPECT_LT(chi_squared, 27.9);  // 9 degrees of freedom: probability 1 in 1,000
}

TEST(BoxCollider, ApartTouchesNothing) {
  for (const std::int64_t count : {0, 1, 2, 2000}) {
    const InitialBodies bodies = spawned({.count = count, .spawn = Spawn::apart});
    EXPECT_EQ(overlaps(bodies), 0) << count;
    EXPECT_EQ(outside(bodies, Box{}, true), 0) << count;
  }
  EXPECT_GT(overlaps(spawned({.count = 2000, .spawn = Spawn::inside})),
            100);  // the overlaps that Spawn::apart avoids
}

TEST(BoxCollider, ApartKeepsClearOfBodiesBefore) {
  InitialBodies bodies;
  bodies.position = {
      {50, 50, 50}, {-10, 50, 50}, {20, 20, 98}};  // a giant sphere, one across a wall, a small one
  bodies.radius = {30, 15, 3};
  append_box_collider({.count = 500, .radius_max = 2, .spawn = Spawn::apart}, Box{}, "g", bodies);
  append_box_collider({.count = 500, .radius_max = 3, .spawn = Spawn::apart, .seed = 2}, Box{}, "g", bodies);
  ASSERT_EQ(bodies.size(), 1003u);
  EXPECT_EQ(overlaps(bodies), 0);
}

TEST(BoxCollider, ApartSaysWhenThereIsNoRoom) {
  try {
    spawned({.count = 4000, .spawn = Spawn::apart});
    FAIL() << "52 % cannot be filled at random";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                testing::MatchesRegex("generators\\[0\\]\\.spawn: no space for 4000 spheres .*their volume "
                                      "is 52\\.. % of the box.*"));
  }
  EXPECT_THROW(spawned({.count = 100'000, .spawn = Spawn::apart}), InputError);
}

TEST(BoxCollider, TheBoxInEffect) {
  Scene scene;
  EXPECT_FALSE(box_in_effect(scene));
  scene.box = Box{{1, 2, 3}, {51, 52, 53}};
  scene.generators.push_back({.count = 5000});
  EXPECT_EQ(box_in_effect(scene)->max, Vector3d(51, 52, 53));
  scene.generators[0].variant = Variant::scaled;
  const double side = scaled_side(5000, 5);
  EXPECT_EQ(box_in_effect(scene)->min, Vector3d(1, 2, 3));
  EXPECT_EQ(box_in_effect(scene)->max, Vector3d(1 + side, 2 + side, 3 + side));
}

TEST(BoxCollider, TheGreatestRadiusIsTheOneThatFits) {
  Scene scene;
  scene.box = Box{};
  scene.generators.emplace_back();
  BoxCollider& generator = scene.generators[0];
  generator.count = 2;
  for (const Variant variant : {Variant::paper, Variant::scaled, Variant::equal}) {
    generator.variant = variant;
    const double most = greatest_radius_max(generator, *scene.box);
    generator.radius_max = most;
    EXPECT_NO_THROW(valid(scene));
    generator.radius_max = 1.001 * most;
    EXPECT_THROW(valid(scene), InputError);
    EXPECT_TRUE(variant != Variant::paper || std::abs(most - 50) < 1e-4) << most;
  }
}

}  // namespace
}  // namespace collidoscope
