// Tests the Pareto front and the cheapest setting against a comparison of all pairs of points. Also tests
// that a setting and the scene made from it agree.

#include <gtest/gtest.h>

#include <cmath>

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/scene/scene_file.h"
#include "tests/random.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

AccuracyPoint point(double ms, double error) {
  AccuracyPoint p;
  p.ms.median = ms;
  p.error = error;
  return p;
}

/// Points with few distinct values, so that some are equal. Some values are unknown.
std::vector<AccuracyPoint> some_points(std::uint32_t seed) {
  Uniform uniform{Random(seed)};
  std::vector<AccuracyPoint> points;
  for (int k = 0; k < 40; ++k) {
    const auto value = [&] {
      const double whole = std::floor(uniform(0, 9));
      return whole == 0 ? not_known : whole;
    };
    points.push_back(point(value(), value()));
  }
  return points;
}

TEST(AccuracyPoint, IsOnTheFrontWhereNothingIsBoth) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    std::vector<AccuracyPoint> points = some_points(seed);
    mark_front(points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const AccuracyPoint& p = points[k];
      bool beaten = !p.has_error() || !p.has_cost();
      for (std::size_t other = 0; other < points.size(); ++other) {
        const AccuracyPoint& q = points[other];
        if (other == k || !q.has_error() || !q.has_cost()) continue;
        const bool as_good = q.ms.median <= p.ms.median && q.error <= p.error;
        const bool better = q.ms.median < p.ms.median || q.error < p.error;
        beaten |= as_good && (better || other < k);  // the first of equal points wins
      }
      EXPECT_EQ(p.on_front, !beaten) << seed << ' ' << k;
    }
  }
}

TEST(AccuracyPoint, IsTheCheapestBelowATolerance) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    const std::vector<AccuracyPoint> points = some_points(seed);
    for (const double tolerance : {0.5, 1.0, 3.5, 8.0, 100.0}) {
      const auto found = cheapest_below(points, tolerance);
      bool any = false;
      for (const AccuracyPoint& p : points) {
        const bool good = p.has_cost() && p.has_error() && p.error <= tolerance;
        any |= good;
        if (good) {
          ASSERT_TRUE(found);
          EXPECT_LE(points[*found].ms.median, p.ms.median);
        }
      }
      EXPECT_EQ(found.has_value(), any);
      if (found) {
        EXPECT_LE(points[*found].error, tolerance);
      }
    }
  }
  EXPECT_FALSE(cheapest_below({}, 1));
}

TEST(AccuracyPoint, NothingIsRecommendedBelowTheReferencesOwnError) {
  const std::vector<AccuracyPoint> points{point(5, 0.9), point(2, 0.4), point(9, 0.1), point(1, not_known)};
  EXPECT_EQ(recommended(points, 0.05, 1).point, 1u);
  EXPECT_EQ(recommended(points, 0.05, 1).unavailable_reason, "");
  EXPECT_EQ(recommended(points, 0.05, 0.2).point, 2u);
  EXPECT_EQ(recommended(points, 0, 0.01).unavailable_reason,
            "no setting has an error of at most 0.01 m; the smallest error is 0.1 m");
  EXPECT_EQ(recommended(points, 1.1, 2).point, std::nullopt);
  EXPECT_EQ(recommended(points, 1.1, 2).unavailable_reason,
            "no setting can be recommended: all errors are below the error of the reference, 1.1 m");
  EXPECT_EQ(recommended(points, 0.2, 0.15).unavailable_reason,
            "no setting can be recommended: the allowed error of 0.15 m is below the error of the reference, "
            "0.2 m");
  EXPECT_EQ(recommended({}, 1, 1).unavailable_reason, "no setting has been measured yet");
  EXPECT_TRUE(all_below_reference(points, 0.9));
  EXPECT_FALSE(all_below_reference(points, 0.8));
  EXPECT_FALSE(all_below_reference({}, 1));
}

TEST(AccuracyPoint, DefaultsAreThoseOfAScene) {
  const AccuracySetting own = accuracy_setting(Physics{}, 4, {});
  EXPECT_EQ(AccuracySetting().integrator, own.integrator);
  EXPECT_EQ(AccuracySetting().rotation_update, own.rotation_update);
  EXPECT_EQ(AccuracySetting().solver, own.solver);
}

TEST(AccuracyPoint, SettingsAreOfTheSceneThatTheyMake) {
  Scene scene = hard_space(Vector3d(0, 0, -9.81));
  const AccuracySetting setting{.time_step = 1.0 / 240,
                                .substeps = 3,
                                .iterations = 5,
                                .solver = Solver::jacobi_split,
                                .precision = Precision::f64,
                                .continuous_collision = true};
  const Scene made = with_setting(scene, setting, {.gravity = true});
  EXPECT_EQ(made.physics.time_step, 1.0 / 240);
  EXPECT_EQ(made.physics.time_step.steps_per_second(), 240);
  EXPECT_EQ(made.physics.substeps, 3);
  EXPECT_EQ(made.physics.iterations, 5);
  EXPECT_EQ(made.physics.solver, Solver::jacobi_split);
  EXPECT_EQ(made.physics.precision, Precision::f64);
  EXPECT_EQ(made.physics.effects, (Effects{.gravity = true, .continuous_collision = true}));
  EXPECT_TRUE(validate(made).empty());
  EXPECT_FALSE(with_setting(scene, {.time_step = 0.0123}, {}).physics.time_step.steps_per_second());
}

}  // namespace
}  // namespace collidoscope
