// Tests the rotation of needle-shaped bodies against the closed form of the symmetric top, with every
// rotation update.
#include "sim_cuda/dynamics/slender_body.h"

#include <gtest/gtest.h>

#include "sim_cuda/dynamics/move.h"
#include "sim_cuda/dynamics/rotation_updates.h"
#include "sim_cuda/reference/free_rotation.h"
#include "tests/order_of_error.h"

namespace collidoscope {
namespace {

TEST(Needle, IsABodyWithTwoEqualMomentsManyTimesTheThird) {
  EXPECT_EQ(slender_axis(Vector3d(1e-6, 1, 1)), 0);
  EXPECT_EQ(slender_axis(Vector3f(1, 1e-6f, 1)), 1);
  EXPECT_EQ(slender_axis(Vector3d(17, 17, 1)), 2);
  EXPECT_EQ(slender_axis(Vector3d(16, 16, 1)), -1);
  EXPECT_EQ(slender_axis(Vector3d(1, 1, 2)), -1) << "a plate";
  EXPECT_EQ(slender_axis(Vector3d(1, 1, 1)), -1) << "a ball";
  EXPECT_EQ(slender_axis(Vector3d(1e-6, 1, 1 + 1e-6)), 0) << "not quite symmetric";
}

TEST(Needle, TurnsAsEulersEquationsSay) {
  const Vector3d inertia(1e-3, 1, 1), spin(7, 1, 0.25);
  const double order = order_of_error(
      [&](int steps) {
        Quaterniond q(1, 0, 0, 0);
        Vector3d w = spin;
        for (int k = 0; k < steps; ++k) rotate_slender(0, q, w, inertia, 1.0 / steps);
        // The symmetry axis of symmetric_top is z.
        const Quaterniond axes(Eigen::AngleAxisd(-1.57079632679489662, Vector3d::UnitY()));
        const Vector3d along_z(inertia.z(), inertia.y(), inertia.x());
        const Quaterniond exact = symmetric_top(along_z, axes * spin, 1);
        return q.angularDistance(axes.conjugate() * exact * axes);
      },
      16);
  EXPECT_NEAR(order, 4, 0.15) << "of the angle of a turn; beside that it is exact";
}

/// Largest relative changes of energy and angular momentum.
template <class Real, class Turn>
std::pair<double, double> change(const Turn& turn, double h) {
  const Vector3<Real> inertia(Real(1e-6), 1, 1);
  Quaternion<Real> q(1, 0, 0, 0);
  Vector3<Real> w(Real(0.5), 1, Real(0.25));
  const auto momentum = [&] {
    const Vector3d own = (q.conjugate() * w).template cast<double>();
    return Vector3d(q.template cast<double>() * Vector3d(1e-6 * own.x(), own.y(), own.z()));
  };
  const Vector3d before = momentum();
  const double energy = before.dot(w.template cast<double>());
  double gained = 0, moved = 0;
  for (int k = 0; k < 1000; ++k) {
    turn(q, w, inertia, static_cast<Real>(h));
    gained = std::max(gained, std::abs(momentum().dot(w.template cast<double>()) / energy - 1));
    moved = std::max(moved, (momentum() - before).norm() / before.norm());
  }
  return {gained, moved};
}

TEST(Needle, KeepsItsEnergyWithEveryUpdateAndEveryStep) {
  for (const double h : {1.0 / 480, 1.0 / 30, 1.0, 1000.0}) {
    for (const auto& [gained, moved] :
         {change<double>([](auto&&... all) { rotate_first_order(all...); }, h),
          change<double>([](auto&&... all) { rotate_lie_group<SecondOrderRotation>(all...); }, h),
          change<double>([](auto&&... all) { rotate_lie_group<FourthOrderRotation>(all...); }, h)}) {
      EXPECT_LT(gained, 1e-12) << h;
      EXPECT_LT(moved, 1e-12) << h;
    }
    const auto [gained, moved] = change<float>([](auto&&... all) { rotate_first_order(all...); }, h);
    EXPECT_LT(gained, 1000 * 1.2e-7) << h;
    EXPECT_LT(moved, 1000 * 1.2e-7) << h;
  }
}

}  // namespace
}  // namespace collidoscope
