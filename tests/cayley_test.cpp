// Tests the Cayley rotation update against its series and the conservation of angular momentum. Normalisation
// in float must have no bias.
#include "sim_cuda/dynamics/cayley.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim_cuda/dynamics/move.h"
#include "sim_cuda/dynamics/rotation_updates.h"
#include "tests/random.h"

namespace collidoscope {
namespace {

TEST(Cayley, TurnsByAnAngleToFourthOrder) {
  for (const double half : {0.01, 0.1, -0.2}) {
    EXPECT_NEAR(std::atan(half_tangent(half)), half, 0.2 * std::pow(std::abs(half), 5));
    Quaterniond q = cayley_rotation<double>(Vector3d(0, 0, half));
    normalise(q);
    EXPECT_NEAR(q.angularDistance(Quaterniond(Eigen::AngleAxisd(2 * half, Vector3d::UnitZ()))), 0,
                0.4 * std::pow(std::abs(half), 5));
  }
  EXPECT_TRUE(std::isfinite(half_tangent(1e30f)));
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
  Vector3f w(0.01f, 1, 0.01f);
  const auto momentum = [&] {
    const Vector3d own = q.cast<double>().conjugate() * w.cast<double>();
    return own.cwiseProduct(inertia.cast<double>()).norm();
  };
  const double before = momentum();
  for (int k = 0; k < 100000; ++k) turn(q, w, inertia, 1 / 120.0f);
  return std::abs(momentum() / before - 1);
}

TEST(Cayley, ATumblerKeepsItsAngularMomentumInFloats) {
  constexpr double half_a_float_a_turn = 6e-8 * 100000;
  EXPECT_LT(growth_of_momentum([](auto&&... all) { rotate_first_order(all...); }), half_a_float_a_turn);
  EXPECT_LT(growth_of_momentum([](auto&&... all) { rotate_lie_group<SecondOrderRotation>(all...); }),
            half_a_float_a_turn);
  EXPECT_LT(growth_of_momentum([](auto&&... all) { rotate_lie_group<FourthOrderRotation>(all...); }),
            half_a_float_a_turn);
}

}  // namespace
}  // namespace collidoscope
