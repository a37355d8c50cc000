// Tests the Cayley map, and normalisation without bias in float.
#include "sim_cuda/dynamics/cayley.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim_cuda/dynamics/rotation_updates.h"
#include "tests/random.h"

namespace collidoscope {
namespace {

TEST(Cayley, TurnsABallByTheCayleyAngle) {
  const Vector3d w(0.3, -2, 1);
  constexpr int steps = 100;
  Quaterniond q(1, 0, 0, 0);
  for (int k = 0; k < steps; ++k) rotate_isotropic(q, w, 1.0 / steps);
  // q' rotates by 2 atan(h |w| / 2) per step about w, in total by |w| t - O(h^2).
  const double angle = 2 * steps * std::atan(w.norm() / steps / 2);
  EXPECT_LT(q.angularDistance(Quaterniond(Eigen::AngleAxisd(angle, w.normalized()))), 1e-12);
}

TEST(Cayley, IsForBodiesWithThreeEqualMoments) {
  EXPECT_TRUE(is_isotropic(Vector3d(2, 2, 2)));
  EXPECT_TRUE(is_isotropic(Vector3f::Constant(std::numeric_limits<float>::infinity()).eval())) << "static";
  for (const Vector3d& moments : {Vector3d(2, 2, 1), Vector3d(2, 1, 2), Vector3d(1, 2, 2)})
    EXPECT_FALSE(is_isotropic(moments));
}

/// Mean of |q|^2 - 1 over random quaternions.
template <class Normalise>
double bias(const Normalise& normalise_it) {
  Uniform uniform{Random(7)};
  double sum = 0;
  constexpr int count = 100000;
  for (int k = 0; k < count; ++k) {
    const auto part = [&] { return static_cast<float>(uniform(-1, 1)); };
    Quaternionf q(part(), part(), part(), part());
    normalise(q);
    normalise_it(q);
    sum += q.cast<double>().squaredNorm() - 1;
  }
  return sum / count;
}

TEST(Cayley, OfQuaternionsNormalisedEvenlyNoMoreAreTooLongThanTooShort) {
  EXPECT_GT(bias([](Quaternionf& q) { normalise(q); }), 3e-8) << "so the plain one will not do";
  EXPECT_LT(std::abs(bias([](Quaternionf& q) { normalise_evenly(q); })), 2e-8);
}

template <class Turn>
double growth_of_momentum(const Turn& turn) {
  const Vector3f inertia(0.1f, 0.2f, 0.3f);
  Quaternionf q(1, 0, 0, 0);
  Vector3d w(0.01f, 1, 0.01f);
  const auto momentum = [&] {
    const Vector3d own = q.cast<double>().conjugate() * w;
    return own.cwiseProduct(inertia.cast<double>()).norm();
  };
  const double before = momentum();
  for (int k = 0; k < 100000; ++k) turn(q, w, inertia, 1 / 120.0f);
  return std::abs(momentum() / before - 1);
}

TEST(Cayley, ATumblerKeepsItsAngularMomentumInFloats) {
  constexpr double half_a_float_a_turn = 6e-8 * 100000;
  EXPECT_LT(growth_of_momentum([](auto&&... all) { rotate_first_order(all...); }), half_a_float_a_turn);
  for (const int parts : {1, 5})
    EXPECT_LT(growth_of_momentum([&](auto&&... all) { rotate_lie_group(all..., RotationParts{parts}); }),
              half_a_float_a_turn);
}

}  // namespace
}  // namespace collidoscope
