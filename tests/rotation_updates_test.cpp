// Tests the rotation updates alone: closed forms, order against a reference solution, conservation for any
// inertia and step. integrators_test.cpp tests their coefficients, free_integrator_test.cpp the solvers.
#include "sim_cuda/dynamics/rotation_updates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim_cuda/reference/free_rotation.h"
#include "tests/order_of_error.h"
#include "tests/random.h"

namespace collidoscope {
namespace {

constexpr RotationParts second_order{1}, fourth_order{5};

/// Angular momentum and energy, from the normalised orientation.
struct Invariants {
  Vector3d momentum;
  double energy;
};
template <class Real>
struct Spin {
  Vector3<Real> inertia;
  Quaternion<Real> q;
  Vector3d w;

  Spin(const Vector3d& moments, const Vector3d& spin, const Quaterniond& orientation)
      : inertia(moments.cast<Real>()),
        q(orientation.cast<Real>()),
        w((orientation * spin).cast<Real>().template cast<double>()) {}
  void rotate(double h, RotationParts parts = second_order) {
    rotate_lie_group(q, w, inertia, static_cast<Real>(h), parts);
  }
  Vector3d body_spin() const {
    const Vector3d stored = w.template cast<Real>().template cast<double>();
    return q.template cast<double>().normalized().conjugate() * stored;
  }
  Invariants invariants() const {
    const Quaterniond axes = q.template cast<double>().normalized();
    const Vector3d spin = body_spin(), l = inertia.template cast<double>().cwiseProduct(spin);
    return {axes * l, l.dot(spin) / 2};
  }
  /// Angle between the third axis and L, in degrees.
  double tilt() const {
    const Vector3d axis = q.template cast<double>().normalized() * Vector3d::UnitZ();
    const Vector3d l = invariants().momentum;
    return std::atan2(axis.cross(l).norm(), axis.dot(l)) * 180 / std::numbers::pi;
  }
};

Quaterniond some_orientation() { return Quaterniond(0.3, 0.5, -0.4, 0.7).normalized(); }

// ---- discs ----

/// The largest deviation of the wobble from 1 degree, in 100 s at 30 steps/s in 4 substeps.
template <class Real>
double change_of_wobble() {
  const double one_degree = std::numbers::pi / 180;
  // L is (I1 w1, 0, I3 w3), 1 degree off the axis.
  Spin<Real> disc(Vector3d(0.01, 0.01, 0.02),
                  30 * Vector3d(2 * std::sin(one_degree), 0, std::cos(one_degree)), some_orientation());
  double worst = 0;
  for (int k = 0; k < 12000; ++k) {
    disc.rotate(1.0 / 120);
    worst = std::max(worst, std::abs(disc.tilt() - 1));
  }
  return worst;
}

TEST(RotationUpdates, ASpinningDiscKeepsItsWobble) {
  EXPECT_LT(change_of_wobble<double>(), 1e-9);
  EXPECT_LT(change_of_wobble<float>(), 1e-3);
}

TEST(RotationUpdates, FirstOrderTurnsADiscOver) {
  Spin<double> disc(Vector3d(0.01, 0.01, 0.02), Vector3d(1, 0, 30), some_orientation());
  const Invariants before = disc.invariants();
  for (int k = 0; k < 240; ++k) rotate_first_order(disc.q, disc.w, disc.inertia, 1.0 / 120);
  EXPECT_GT(disc.tilt(), 80);
  EXPECT_GT(disc.invariants().energy, 1.9 * before.energy);
  EXPECT_LT((disc.invariants().momentum - before.momentum).norm(), 1e-12 * before.momentum.norm());
}

// ---- closed forms and order ----

TEST(RotationUpdates, ASymmetricTopIsExactForEveryStep) {
  for (const Vector3d& inertia :
       {Vector3d(2, 2, 1), Vector3d(1, 1, 2), Vector3d(1, 1, 1e-6), Vector3d(3, 3, 2.9)})
    for (const int axis : {0, 1, 2})
      for (const int steps : {1, 7, 1000})
        for (const RotationParts& parts : {second_order, fourth_order}) {
          const Vector3d spin(0.5, 0.3, 3);
          const double time = 20;
          const Quaterniond exact = symmetric_top(inertia, spin, time);
          // The symmetry axis of symmetric_top is z. Renames the axes.
          const auto renamed = [&](const Vector3d& v) {
            return Vector3d(v[(2 - axis + 3) % 3], v[(3 - axis + 3) % 3], v[(4 - axis + 3) % 3]);
          };
          Spin<double> top(renamed(inertia), renamed(spin), Quaterniond(1, 0, 0, 0));
          for (int k = 0; k < steps; ++k) top.rotate(time / steps, parts);
          const Vector3d vector = renamed(exact.vec());
          const Quaterniond expected(exact.w(), vector.x(), vector.y(), vector.z());
          EXPECT_LT(top.q.angularDistance(expected), 2e-12) << inertia << ", " << axis << ", " << steps;
        }
}

/// Orientation of a free body after `time` s: RK4 in 20,000 steps, with constant L.
Quaterniond reference(const Spin<double>& start, double time) {
  const Vector3d momentum = start.invariants().momentum;
  const auto rate = [&](const Eigen::Vector4d& y) {
    const Quaterniond q(y);
    const Vector3d w = (q.normalized().conjugate() * momentum).cwiseQuotient(start.inertia) / 2;
    return Eigen::Vector4d((q * Quaterniond(0, w.x(), w.y(), w.z())).coeffs());
  };
  constexpr int steps = 20000;
  const double h = time / steps;
  Eigen::Vector4d y = start.q.coeffs();
  for (int k = 0; k < steps; ++k) {
    const Eigen::Vector4d a = rate(y), b = rate(y + h / 2 * a), c = rate(y + h / 2 * b), d = rate(y + h * c);
    y += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return Quaterniond(y).normalized();
}

TEST(RotationUpdates, AsymmetricBodiesConvergeInOrientation) {
  struct Case {
    Vector3d inertia, spin;
  };
  for (const Case& each : {Case{{1, 2, 2.5}, {0.9, 0.3, 1.2}}, Case{{3, 1, 2}, {0.1, 0.1, 2}},
                           Case{{1, 1.2, 2}, {0.5, 0.3, 2}}, Case{{1, 0.1, 1.05}, {1, 2, 1}}})
    for (const RotationParts& parts : {second_order, fourth_order}) {
      const Spin<double> start(each.inertia, each.spin, some_orientation());
      const Quaterniond exact = reference(start, 2);
      const auto error = [&](int steps) {
        Spin<double> body = start;
        for (int k = 0; k < steps; ++k) body.rotate(2.0 / steps, parts);
        return body.q.angularDistance(exact);
      };
      EXPECT_NEAR(order_of_error(error, 16), parts.count == 5 ? 4 : 2, 0.2) << each.inertia;
    }
}

// ---- conservation ----

struct RotationChange {
  double energy = 0, momentum = 0, rise = 0;  // the largest; relative; `rise`: above an earlier minimum
};
template <class Real>
RotationChange change_of(Spin<Real> body, double h, int steps, RotationParts parts = second_order) {
  const Invariants before = body.invariants();
  const double scale = before.energy;
  double lowest = before.energy;
  RotationChange change;
  for (int k = 0; k < steps; ++k) {
    body.rotate(h, parts);
    const Invariants now = body.invariants();
    lowest = std::min(lowest, now.energy);
    change.rise = std::max(change.rise, (now.energy - lowest) / scale);
    change.energy = std::max(change.energy, std::abs(now.energy - before.energy) / scale);
    change.momentum =
        std::max(change.momentum, (now.momentum - before.momentum).norm() / before.momentum.norm());
  }
  return change;
}

/// Three moments, none above the sum of the others. `decades`: range of their ratios.
Vector3d any_inertia(Uniform& uniform, double decades) {
  const auto any = [&] { return std::pow(10, uniform(-decades, 0)); };
  const double x = any(), y = any(), z = any(), size = std::pow(10, uniform(-6, 6));
  return size * Vector3d(y + z, z + x, x + y);
}
/// Bound in float for 1000 steps: half a unit in the last place of w per step. In slow rotation, the rounding
/// errors of successive steps are similar, and add up.
constexpr double float_rounding = 1000 * 0x1p-24;

/// A rotation by 1e-4 to 100 rad per step of 0.01 s.
Vector3d any_spin(Uniform& uniform) {
  return uniform.vector(1).normalized() * std::pow(10, uniform(-4, 2)) / 0.01;
}

/// Checks 1000 steps in double and in float.
void expect_constant(const Vector3d& inertia, const Vector3d& spin, const RotationParts& parts) {
  const RotationChange in_double =
                           change_of(Spin<double>(inertia, spin, some_orientation()), 0.01, 1000, parts),
                       in_float =
                           change_of(Spin<float>(inertia, spin, some_orientation()), 0.01, 1000, parts);
  ASSERT_LT(in_double.energy, 1e-12) << inertia << ", " << spin;
  ASSERT_LT(in_double.momentum, 1e-12) << inertia << ", " << spin;
  ASSERT_LT(in_float.energy, float_rounding) << inertia << ", " << spin;
  ASSERT_LT(in_float.momentum, float_rounding) << inertia << ", " << spin;
}

TEST(RotationUpdates, EnergyAndAngularMomentumAreConstantForEveryInertiaAndStep) {
  Uniform uniform{Random(5)};
  for (int k = 0; k < 300; ++k) {
    const Vector3d inertia = any_inertia(uniform, 1), spin = any_spin(uniform);
    expect_constant(inertia, spin, k % 2 == 0 ? second_order : fourth_order);
  }
}

TEST(RotationUpdates, SoTheyAreForNeedlesAndBlades) {
  Uniform uniform{Random(6)};
  for (int k = 0; k < 300; ++k) {
    // w is stored in world axes. Its rounding errors are a part of |w|, and change L across a needle that
    // spins about its own axis by more than a part of |L|. Therefore the spin here is mainly across.
    const Vector3d inertia = any_inertia(uniform, 6);
    Vector3d spin = any_spin(uniform);
    for (int axis = 0; axis < 3; ++axis) spin[axis] *= inertia[axis] / inertia.maxCoeff();
    expect_constant(inertia, spin, k % 2 == 0 ? second_order : fourth_order);
  }
}

TEST(RotationUpdates, EnergyRisesByRoundingOnly) {
  struct Case {
    Vector3d inertia, spin;
  };
  for (const Case& each : {Case{{0.01, 0.01, 0.02}, {1, 0, 30}}, Case{{0.1, 0.2, 0.3}, {0.01, 1, 0.01}},
                           Case{{1, 1, 2}, {0.5, 0.25, 2}}, Case{{1e-6, 1, 1}, {0.5, 1, 0.25}},
                           Case{{1e-4, 1, 1.00005}, {0.5, 1, 0.25}}})
    for (const RotationParts& parts : {second_order, fourth_order}) {
      const auto rise = [&](auto real) {
        return change_of(Spin<decltype(real)>(each.inertia, each.spin, some_orientation()), 1.0 / 120, 12000,
                         parts)
            .rise;
      };
      EXPECT_LT(rise(0.0f), 1e-6) << each.inertia;
      EXPECT_LT(rise(0.0), 1e-11) << each.inertia;
    }
}

TEST(RotationUpdates, NormalisationAddsNoEnergy) {
  EXPECT_LT(change_of(Spin<double>({0.1, 0.2, 0.3}, {1, 20, 3}, some_orientation()), 1.0 / 120, 100000).rise,
            2e-12);
}

/// A body that rotates almost about its middle axis leaves it as exp(rate t).
TEST(RotationUpdates, RoundingDoesNotDisturbARotationAboutTheMiddleAxis) {
  const Vector3d inertia(1, 2, 3);
  const double off = 2e-8, rate = 2 * std::sqrt((3 - 2) * (2 - 1) / 3.0);
  Spin<double> body(inertia, Vector3d(off, 2, 0), Quaterniond(1, 0, 0, 0));
  const double h = 0.01;
  for (int k = 0; k < 400; ++k) body.rotate(h);
  EXPECT_NEAR(body.body_spin().x() / (off * std::cosh(rate * 400 * h)), 1, 0.02);
}

TEST(RotationUpdates, PrincipalAxesAreFixedPoints) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double h : {0.01, 100.0}) {
      Spin<double> body(Vector3d(1, 2, 2.5), 3 * Vector3d::Unit(axis), Quaterniond(1, 0, 0, 0));
      for (int k = 0; k < 100; ++k) body.rotate(h, fourth_order);
      EXPECT_EQ(body.body_spin().cwiseAbs().sum(), std::abs(body.body_spin()[axis]));
      EXPECT_NEAR(body.body_spin()[axis], 3, 1e-14);
    }
}

TEST(RotationUpdates, ABodyAtRestStays) {
  Spin<float> body(Vector3d(1, 2, 2.5), Vector3d(0, 0, 0), some_orientation());
  const Quaternionf q = body.q;
  EXPECT_FALSE(rotate_lie_group(body.q, body.w, body.inertia, 0.01f, second_order));
  EXPECT_EQ(body.q.coeffs(), q.coeffs());
  EXPECT_EQ(body.w, Vector3d(0, 0, 0));
}

// ---- correction of the energy ----

TEST(EnergyCorrection, GivesEveryEnergyThatTheBodyCanHave) {
  Uniform uniform{Random(9)};
  int far = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vector3d b = uniform.vector(1), l = uniform.vector(1).normalized();
    const double wanted = uniform(b.minCoeff(), b.maxCoeff());
    const Vector3d moved = detail::with_energy(l, b, wanted);
    ASSERT_NEAR(moved.norm(), 1, 1e-15);
    ASSERT_NEAR(b.dot(moved.cwiseProduct(moved)), wanted, 1e-13) << b << ", " << l;
    ASSERT_GE(l.dot(moved), -1e-15) << "at most a quarter turn";
    const Quaterniond turn = detail::rotation_between(l, moved);
    ASSERT_LT((turn * moved - l).norm(), 1e-15);
    const Vector3d direction = l.cross(b.cwiseProduct(l));  // normal of the circle along the gradient
    far += std::abs(direction.normalized().dot(moved)) > 1e-6;
  }
  EXPECT_GT(far, 500) << "the other circle is used, too";
}

TEST(EnergyCorrection, AtAPrincipalAxisNeedsNoGradient) {
  const Vector3d b(1, 2, 3);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d l = -Vector3d::Unit(axis);
    EXPECT_EQ(detail::with_energy(l, b, b[axis]), l);
  }
  // From the middle axis there is no gradient, but a way up and a way down.
  for (const double wanted : {1.0, 1.5, 2.5, 3.0}) {
    const Vector3d moved = detail::with_energy(Vector3d::UnitY(), b, wanted);
    EXPECT_NEAR(b.dot(moved.cwiseProduct(moved)), wanted, 1e-15);
  }
  // Rounding beyond the extremes.
  EXPECT_EQ(detail::with_energy(Vector3d::UnitZ(), b, 3 + 1e-15), Vector3d::UnitZ());
  EXPECT_EQ(detail::with_energy(Vector3d::UnitX(), b, 1 - 1e-15), Vector3d::UnitX());
}

// ---- first_order ----

TEST(SlenderBody, IsABodyWithTwoMomentsManyTimesTheThird) {
  EXPECT_EQ(slender_axis(Vector3d(1e-6, 1, 1)), 0);
  EXPECT_EQ(slender_axis(Vector3f(1, 1e-6f, 1)), 1);
  EXPECT_EQ(slender_axis(Vector3d(17, 17, 1)), 2);
  EXPECT_EQ(slender_axis(Vector3d(16, 16, 1)), -1);
  EXPECT_EQ(slender_axis(Vector3d(1, 1, 2)), -1) << "a plate";
  EXPECT_EQ(slender_axis(Vector3d(1e-6, 1, 1 + 1e-6)), 0) << "not quite symmetric";
}

TEST(SlenderBody, KeepsItsEnergyWithFirstOrderForEveryStep) {
  for (const double h : {1.0 / 480, 1.0 / 30, 1.0, 1000.0}) {
    Spin<double> needle(Vector3d(1e-6, 1, 1), Vector3d(0.5, 1, 0.25), some_orientation());
    const Invariants before = needle.invariants();
    for (int k = 0; k < 1000; ++k) rotate_first_order(needle.q, needle.w, needle.inertia, h);
    EXPECT_NEAR(needle.invariants().energy / before.energy, 1, 1e-12) << h;
    EXPECT_LT((needle.invariants().momentum - before.momentum).norm(), 1e-12 * before.momentum.norm()) << h;
  }
}

}  // namespace
}  // namespace collidoscope
