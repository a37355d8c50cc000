// Tests the error measures for states and distributions against values computed by hand. Every accuracy
// result is based on these measures.

#include "sim_cuda/accuracy/errors.h"
#include "sim_cuda/accuracy/record.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/core/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace collidoscope {
namespace {

BodyStates states(std::size_t count) {
  BodyStates made;
  made.position.resize(count, Vector3d(0, 0, 0));
  made.velocity.resize(count, Vector3d(0, 0, 0));
  made.angular_velocity.resize(count, Vector3d(0, 0, 0));
  made.orientation.resize(count, Quaterniond(1, 0, 0, 0));
  return made;
}

InitialBodies bodies(std::size_t count) {
  InitialBodies made;
  made.position.resize(count, Vector3d(0, 0, 0));
  made.radius.resize(count, 2);
  made.mass.resize(count, 3);
  return made;
}

TEST(AccuracyErrors, AreDistancesOfABodysMatter) {
  BodyStates a = states(1), b = states(1);
  a.position[0] = Vector3d(3, 4, 0);
  EXPECT_DOUBLE_EQ(rms_distance(a, b, bodies(1), true), 5);
  // A ball of 2 m turned by 90 degrees about any axis: the distance is 2 sin 45 times sqrt(2/5) r.
  a = b;
  const double c = std::sqrt(0.5);
  a.orientation[0] = Quaterniond(c, 0, c * 0.6, c * 0.8);
  EXPECT_NEAR(rms_distance(a, b, bodies(1), true), std::sqrt(2.0) * std::sqrt(0.4) * 2, 1e-12);
  EXPECT_EQ(rms_distance(a, b, bodies(1), false), 0);
  // -q is the same rotation as q.
  a.orientation[0] = Quaterniond(-1, 0, 0, 0);
  EXPECT_EQ(rms_distance(a, b, bodies(1), true), 0);
  // The distance follows from the moment of inertia about the axis: 12 kg m^2 at 3 kg, turned by 180 degrees
  // about x.
  InitialBodies box = bodies(1);
  box.inertia = {Vector3d(12, 20, 25)};
  a.orientation[0] = Quaterniond(0, 1, 0, 0);
  EXPECT_NEAR(rms_distance(a, b, box, true), 2 * std::sqrt(12.0 / 3), 1e-12);
}

TEST(AccuracyErrors, LeaveOutWhatNoForceMovesAndTellWhatIsLost) {
  BodyStates a = states(2), b = states(2);
  InitialBodies two = bodies(2);
  a.position[1] = Vector3d(7, 0, 0);
  EXPECT_NEAR(rms_distance(a, b, two, false), 7 / std::sqrt(2.0), 1e-12);
  two.motion = {Motion::dynamic, Motion::kinematic};
  EXPECT_EQ(rms_distance(a, b, two, false), 0);
  a.position[0].x() = std::nan("");
  EXPECT_TRUE(std::isinf(rms_distance(a, b, two, false)));
}

TEST(AccuracyErrors, SpreadBetweenGroupsOfBodies) {
  // 16 groups of one body: the standard error of the mean of squares is the standard deviation divided by 4.
  BodyStates a = states(16), b = states(16);
  for (std::size_t k = 0; k < 16; ++k) a.position[k].x() = k % 2 == 0 ? 1 : 2;
  ErrorSum sum;
  sum.add(squared_distances(a, b, bodies(16), false));
  sum.add(squared_distances(a, b, bodies(16), false));
  const auto [rms, low, high, worst] = sum.result(bodies(16));
  const double off = 1.5 / std::sqrt(15.0);
  EXPECT_NEAR(rms, std::sqrt(2.5), 1e-12);
  EXPECT_NEAR(low, std::sqrt(2.5 - off), 1e-12);
  EXPECT_NEAR(high, std::sqrt(2.5 + off), 1e-12);
  EXPECT_EQ(worst, 2);
}

TEST(AccuracyErrors, OfDistributionsAreWhatMustBeMoved) {
  EXPECT_EQ(distribution_distance({1, 2, 3}, {3, 1, 2}), 0);
  EXPECT_DOUBLE_EQ(distribution_distance({0, 0, 0, 0}, {1, 1, 0, 0}), 0.5);
  EXPECT_DOUBLE_EQ(distribution_distance({5, 1}, {3, 2}), 1.5);
  EXPECT_TRUE(std::isinf(distribution_distance({1, INFINITY}, {1, 2})));
  EXPECT_EQ(distribution_distance({}, {}), 0);
}

TEST(AccuracyErrors, FitAnOrderAndAQuantile) {
  EXPECT_NEAR(fitted_order({1, 0.5, 0.25}, {3, 0.75, 0.1875}), 2, 1e-12);
  EXPECT_TRUE(std::isnan(fitted_order({1}, {1})));
  EXPECT_DOUBLE_EQ(quantile<double>({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile<double>({4, 1, 3, 2, 5}, 0.25), 2);
  EXPECT_TRUE(std::isnan(quantile<double>({}, 0.5, NAN)));
}

TEST(AccuracyRecord, ReadsWhatItWroteAndRefusesTheRest) {
  AccuracyRecord record;
  record.scene = "a \"scene\"";
  record.problem_hash = "0123456789abcdef";
  record.points.resize(2);
  record.points[0].series_name = "soft_step f32";
  record.points[0].error = 0.1;
  record.points[0].ms_runs = {1, 2};
  record.points[0].setting.continuous_collision = true;
  record.points[1].error = INFINITY;  // the run failed
  record.warnings = {"one"};
  const AccuracyRecord read = parse_record(write_record(record), "file");
  EXPECT_EQ(write_record(read), write_record(record));
  EXPECT_EQ(read.physics_version, physics_version);
  std::string older = write_record(record);
  const std::string number = "  \"physics_version\": " + std::to_string(physics_version) + ",\n";
  ASSERT_NE(older.find(number), std::string::npos);
  older.erase(older.find(number), number.size());
  EXPECT_EQ(parse_record(older, "file").physics_version, 1);
  EXPECT_EQ(read.points[0].error, 0.1);
  EXPECT_EQ(read.points[0].setting, record.points[0].setting);
  EXPECT_FALSE(read.points[0].has_cost());
  EXPECT_TRUE(std::isinf(read.points[1].error));
  for (const char* text : {"", "{}", "[1]", R"({"suite": "paper"})", "{\"suite\": \"accuracy\"}"}) {
    try {
      parse_record(text, "file");
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find("file: not an accuracy study: "), 0u);
    }
  }
}

}  // namespace
}  // namespace collidoscope
