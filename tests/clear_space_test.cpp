#include "sim_cuda/solver/clear_space.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

namespace collidoscope {
namespace {

template <class Real>
class ClearSpaceOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(ClearSpaceOf, Precisions);

constexpr int faces = 6;

/// As SoftWalls::may_touch(), without margins.
template <class Real>
bool touches_a_face(const Box& box, const Vector3<Real>& x, Real radius, const Vector3<Real>& v, Real h) {
  for (int k = 0; k < 3; ++k)
    for (const Real sign : {Real(1), Real(-1)}) {
      const Real offset = sign * static_cast<Real>(sign > 0 ? box.min[k] : box.max[k]);
      const Real gap = sign * x[k] - offset - radius;
      if (gap < 0 || sign * v[k] + gap * (1 / h) < 0) return true;
    }
  return false;
}

TYPED_TEST(ClearSpaceOf, HoldsNoBodyThatTouchesAFaceAndManyOthers) {
  using Real = TypeParam;
  std::mt19937_64 random(1);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int clear = 0, found = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    const double size = std::pow(10, uniform(-2, 4)), away = trial % 2 == 0 ? 0 : std::pow(10, uniform(0, 5));
    Box box;
    for (int k = 0; k < 3; ++k) {
      box.min[k] = uniform(-away, away);
      box.max[k] = box.min[k] + size;
    }
    const Real h = static_cast<Real>(std::pow(10, uniform(-4, -1)));
    const Real radius = static_cast<Real>(size * uniform(0, 0.1));
    Vector3<Real> x, v;
    for (int k = 0; k < 3; ++k) {
      x[k] = static_cast<Real>(uniform(box.min[k], box.max[k]));
      // The body ends near a face, so that rounding decides.
      const double face = uniform(0, 1) < 0.5 ? box.min[k] + radius : box.max[k] - radius;
      v[k] = static_cast<Real>((face - x[k]) / h * (1 + 1e-6 * uniform(-1, 1)) * (trial % 3 == 0 ? 1 : 0.5));
    }
    const auto space = ClearSpace<Real>::of(box, faces, h);
    const bool contains = space.contains(x, radius, space.time * v);
    const bool touches = touches_a_face(box, x, radius, v, h);
    ASSERT_FALSE(contains && touches) << trial;
    if (touches || away > 100 * size) continue;
    ++clear;
    found += contains ? 1 : 0;
  }
  EXPECT_GT(clear, 5000);
  EXPECT_GT(found, 0.2 * clear);
}

TYPED_TEST(ClearSpaceOf, HoldsNothingWithoutABoxWithOtherPlanesOrForNumbersThatAreNotFinite) {
  using Real = TypeParam;
  const Box box;
  const Vector3<Real> zero = Vector3<Real>::Zero();
  const Vector3<Real> middle = Vector3<Real>::Constant(50);
  EXPECT_TRUE(ClearSpace<Real>::of(box, faces, 1).contains(middle, 1, zero));
  EXPECT_FALSE(ClearSpace<Real>::of(std::nullopt, faces, 1).contains(middle, 1, zero));
  EXPECT_FALSE(ClearSpace<Real>::of(box, faces + 1, 1).contains(middle, 1, zero));
  for (const Real bad : {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()})
    for (int k = 0; k < 3; ++k) {
      Vector3<Real> x = middle, way = zero;
      x[k] = way[k] = bad;
      EXPECT_FALSE(ClearSpace<Real>::of(box, faces, 1).contains(x, 1, zero));
      EXPECT_FALSE(ClearSpace<Real>::of(box, faces, 1).contains(middle, 1, way));
    }
}

}  // namespace
}  // namespace collidoscope
