// Tests the contact times of free flights against their nearest points in long double and against a dense
// search.

#include "sim_cuda/reference/contact_time.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/random.h"

namespace collidoscope {
namespace {

TEST(TimeToContact, IsTheFirstMomentOfTouch) {
  Uniform uniform{Random(5)};
  int hits = 0;
  for (int k = 0; k < 200000; ++k) {
    const double reach = uniform(0.01, 2);
    const Vector3d v = uniform.vector(3);
    Vector3d d = uniform.vector(4);
    if (k % 4 == 0) {  // grazing: passes at the contact distance, up to 1e-6
      const Vector3d across = d.cross(v).normalized();
      d = across * reach * (1 + uniform(-1e-6, 1e-6)) - uniform(0.1, 3) * v;
    }
    if (d.norm() <= reach) continue;
    using Wide = Vector3<long double>;
    const Wide wide_d = d.cast<long double>(), wide_v = v.cast<long double>();
    const long double nearest_at = -wide_d.dot(wide_v) / wide_v.squaredNorm();
    const long double miss = (wide_d + nearest_at * wide_v).norm() - reach;
    const double time = time_to_contact(d, v, reach, 0);
    if (nearest_at <= 0 || miss > 1e-14) {
      ASSERT_EQ(time, never);
      continue;
    }
    if (miss > -1e-14) continue;
    ++hits;
    // The time is not after the nearest point, and the gap there is zero within rounding.
    ASSERT_LE(time, static_cast<double>(nearest_at) * (1 + 1e-15));
    ASSERT_NEAR(static_cast<double>((wide_d + time * wide_v).norm() - reach), 0, 2e-15 * (d.norm() + reach));
  }
  EXPECT_GT(hits, 20000);
}

TEST(TimeToContact, OfWhatOverlapsTheSignOfApproachDecides) {
  const Vector3d d(1.9, 0, 0);
  EXPECT_EQ(time_to_contact(d, Vector3d(-1, 0, 0), 2, 1e-15), 0);
  EXPECT_EQ(time_to_contact(d, Vector3d(1, 0, 0), 2, 1e-15), never);
  EXPECT_EQ(time_to_contact(d, Vector3d(0, 1, 0), 2, 1e-15), never);
  EXPECT_EQ(time_to_contact(d, Vector3d(-1e-16, 0, 0), 2, 1e-15), never);          // rounding
  EXPECT_EQ(time_to_contact(Vector3d(2, 0, 0), Vector3d(-1, 0, 0), 2, 1e-15), 0);  // touching
  EXPECT_EQ(time_to_contact(Vector3d(3, 0, 0), Vector3d(0, 0, 0), 2, 1e-15), never);
}

TEST(TimeToPlane, IsTheNextMomentOfTouchWhileApproaching) {
  Uniform uniform{Random(6)};
  const auto value = [&](double size) { return uniform(-1, 1) < -0.9 ? 0.0 : uniform(-size, size); };
  int found = 0, turned = 0;
  for (int k = 0; k < 200000; ++k) {
    const double scale = k % 3 == 0 ? 1e-9 : 1;
    const double gap = value(scale), speed = value(2), pull = value(10);
    const double time = time_to_plane(gap, speed, pull, 0);
    const auto gap_at = [&](double t) { return static_cast<double>(gap + (speed + 0.5L * pull * t) * t); };
    const auto speed_at = [&](double t) { return speed + pull * t; };
    ASSERT_GE(time, 0);
    if (time == 0) {
      ASSERT_TRUE(gap <= 0 && (speed < 0 || (speed == 0 && pull < 0))) << gap << ' ' << speed << ' ' << pull;
      continue;
    }
    // At no earlier time is the body below the plane and falling.
    const double horizon = time == never ? 10 : time;
    for (int i = 1; i < 50; ++i) {
      const double t = horizon * i / 50;
      ASSERT_FALSE(gap_at(t) < -1e-13 && speed_at(t) < -1e-13) << gap << ' ' << speed << ' ' << pull;
    }
    if (time == never) continue;
    ++found;
    const bool at_plane = std::abs(gap_at(time)) <
                          4e-16 * (std::abs(gap) + 2 * std::abs(speed * time) + std::abs(pull) * time * time);
    const bool turns_below = gap_at(time) < 0 && std::abs(speed_at(time)) < 1e-15 * std::abs(speed);
    ASSERT_TRUE(at_plane || turns_below) << gap << ' ' << speed << ' ' << pull << ' ' << gap_at(time);
    ASSERT_LE(speed_at(time), 1e-15 * std::abs(speed));
    turned += !at_plane;
  }
  EXPECT_GT(found, 50000);
  EXPECT_GT(turned, 100);
  EXPECT_EQ(time_to_plane(0, 3, -10, 1e-15), 0.6);  // a bounce from the plane itself, exact to the last bit
  EXPECT_EQ(time_to_plane(0, 0, -10, 1e-15), 0);    // at rest
  EXPECT_EQ(time_to_plane(-1e-3, -1, 10, 0), 0);
  EXPECT_EQ(time_to_plane(-1e-17, -1e-17, 0, 1e-16), never);  // slides along the plane
}

}  // namespace
}  // namespace collidoscope
