// The rigid motion of several bodies (rigid_motion.h).

#include "sim_cuda/solver/rigid_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace collidoscope {
namespace {

struct MovingPoint {
  double mass;
  Vector3d position, velocity;
};

std::vector<MovingPoint> random_points(int count, bool on_a_line) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> of(-1, 1);
  std::vector<MovingPoint> points;
  for (int k = 0; k < count; ++k)
    points.push_back(
        {1.1 + of(random),
         on_a_line ? Vector3d(0, 0, 5 + of(random)) : Vector3d(40 + of(random), of(random), of(random)),
         Vector3d(of(random), of(random), 3 + of(random))});
  return points;
}

RigidMotion motion_of(const std::vector<MovingPoint>& points) {
  const Vector3d origin = points[0].position, base = points[0].velocity;
  RigidSums sums;
  for (const MovingPoint& p : points) sums.add(p.mass, p.position - origin, p.velocity - base);
  RigidMotion motion = sums.motion();
  motion.centre += origin;
  motion.velocity += base;
  return motion;
}

TEST(RigidMotion, RelativeMotionHasNoMomentum) {
  for (const bool on_a_line : {false, true}) {
    const std::vector<MovingPoint> points = random_points(20, on_a_line);
    const RigidMotion motion = motion_of(points);
    Vector3d momentum(0, 0, 0), angular(0, 0, 0);
    double relative_energy = 0, mixed = 0;
    for (const MovingPoint& p : points) {
      const Vector3d rigid = motion.velocity_at(p.position), relative = p.velocity - rigid;
      momentum += p.mass * relative;
      angular += p.mass * p.position.cross(relative);
      relative_energy += p.mass / 2 * relative.dot(relative);
      mixed += p.mass * relative.dot(rigid);
    }
    EXPECT_LT(momentum.norm(), 1e-12) << on_a_line;
    EXPECT_LT(angular.norm(), 1e-12) << on_a_line;
    EXPECT_LT(std::abs(mixed), 1e-11) << on_a_line;  // so scaling the relative motion removes its energy only
    EXPECT_GT(relative_energy, 0.1);
  }
}

TEST(RigidMotion, OfARotatingBodyIsItsMotion) {
  const Vector3d centre(1, -2, 3), velocity(4, 5, -6), spin(0.3, -0.7, 1.1);
  const Quaterniond axes(Eigen::AngleAxisd(0.8, Vector3d(1, 2, -1).normalized()));
  std::vector<MovingPoint> points = random_points(8, false);
  RigidSums sums;
  for (MovingPoint& p : points) {
    p.velocity = velocity + spin.cross(Vector3d(p.position - centre));
    sums.add(p.mass, p.position, p.velocity);
    sums.add_rotation(Vector3d(0.1, 0.5, 0.3), axes, spin);
  }
  const RigidMotion motion = sums.motion();
  EXPECT_LT((motion.spin - spin).norm(), 1e-12);
  for (const MovingPoint& p : points) EXPECT_LT((motion.velocity_at(p.position) - p.velocity).norm(), 1e-11);
}

}  // namespace
}  // namespace collidoscope
