// Compares friction of bodies with unequal moments of inertia with a search over all impulses.

#include "sim_cuda/solver/tangent_response.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/energy_scenes.h"

namespace collidoscope {
namespace {

/// Two bodies that touch.
struct TangentPair {
  Vector3d normal, slip;
  AngularState<double> body[2];
  double arm[2], inverse_mass;

  /// Change of the slip by an impulse on the second body.
  Vector3d response(const Vector3d& impulse) const {
    Vector3d sum = inverse_mass * impulse;
    for (int k = 0; k < 2; ++k) {
      AngularState<double> angular = body[k];
      angular.velocity = Vector3d(0, 0, 0);
      angular.apply_angular_impulse(arm[k] * normal.cross(impulse));
      sum += arm[k] * angular.velocity.cross(normal);
    }
    return tangential_part<double>(sum, normal);
  }
  /// Change of the kinetic energy by an impulse, where `accumulated` acts already.
  double energy(const Vector3d& impulse, const Vector3d& accumulated) const {
    const Vector3d change = impulse - accumulated;
    return change.dot(slip) + change.dot(response(change)) / 2;
  }
};

TangentPair any_pair(Uniform& uniform) {
  Scene scene;
  for (int k = 0; k < 2; ++k)
    scene.bodies.push_back(ball(random_ratio(uniform, 100), uniform(0.1, 1), Vector3d(0, 0, 0)));
  set_inertias(scene, uniform);
  TangentPair pair;
  pair.normal = random_direction(uniform);
  pair.slip = tangential_part<double>(uniform.vector(3), pair.normal);
  pair.inverse_mass = 0;
  for (int k = 0; k < 2; ++k) {
    const Body& body = scene.bodies[static_cast<std::size_t>(k)];
    pair.body[k] = {Vector3d(0, 0, 0), *body.inertia, body.orientation};
    pair.arm[k] = body.radius;
    pair.inverse_mass += 1 / *body.mass;
  }
  return pair;
}

TEST(TangentResponse, LeavesTheLeastEnergyWithinTheLimit) {
  Uniform uniform{Random(7)};
  int sticking = 0, sliding = 0;
  for (int k = 0; k < 500; ++k) {
    const TangentPair pair = any_pair(uniform);
    TangentResponse<double> response(pair.normal, pair.inverse_mass);
    for (int i = 0; i < 2; ++i) response.add(pair.body[i], pair.arm[i] * pair.arm[i]);
    const double limit = random_ratio(uniform, 1e4) / 100;
    const Vector3d accumulated =
        limit * uniform(0, 1) * tangential_part<double>(random_direction(uniform), pair.normal);
    const Vector3d found = response.solve(pair.slip, accumulated, limit);
    EXPECT_NEAR(found.dot(pair.normal), 0, 1e-12 * limit);
    ASSERT_LE(found.norm(), limit * (1 + 1e-12));
    // A direction in which the energy falls must lead out of the disc of allowed impulses.
    const Vector3d left = pair.slip + pair.response(found - accumulated);
    if (found.norm() < limit * (1 - 1e-9)) {
      ++sticking;
      EXPECT_LT(left.norm(), 1e-6 * pair.slip.norm()) << k;
    } else {
      ++sliding;
      EXPECT_LT(left.cross(found).norm(), 1e-3 * left.norm() * found.norm()) << k;
      EXPECT_LE(left.dot(found), 0) << k;
    }
    const double least = pair.energy(found, accumulated);
    const Vector3d side = pair.normal.cross(found.norm() > 0 ? found : pair.slip).normalized(),
                   along = side.cross(pair.normal);
    for (int ring = 0; ring <= 20; ++ring)
      for (int step = 0; step < 60; ++step) {
        const double angle = step * 2 * std::numbers::pi / 60, size = limit * ring / 20;
        const Vector3d other = size * (std::cos(angle) * along + std::sin(angle) * side);
        ASSERT_GE(pair.energy(other, accumulated), least - 1e-6 * std::abs(least)) << k;
      }
  }
  EXPECT_GT(sticking, 50);
  EXPECT_GT(sliding, 50);
}

TEST(TangentResponse, OfAVanishingLimitIsFinite) {
  Uniform uniform{Random(8)};
  for (const double limit : {0.0, 1e-300, 1e-150, 1e-99, 1e-45, 1e-22}) {
    const TangentPair pair = any_pair(uniform);
    TangentResponse<double> response(pair.normal, pair.inverse_mass);
    for (int i = 0; i < 2; ++i) response.add(pair.body[i], pair.arm[i] * pair.arm[i]);
    EXPECT_LE(response.solve(pair.slip, Vector3d(0, 0, 0), limit).norm(), limit * 1.001);
    TangentResponse<float> narrow(pair.normal.cast<float>(), static_cast<float>(pair.inverse_mass));
    for (const AngularState<double>& body : pair.body)
      narrow.add({body.velocity.cast<float>(), body.inertia.cast<float>(), body.axes.cast<float>()}, 1.0F);
    const float small = static_cast<float>(limit);
    EXPECT_LE(narrow.solve(pair.slip.cast<float>(), Vector3f(0, 0, 0), small).norm(),
              small * 1.001F + 1e-37F);
  }
}

}  // namespace
}  // namespace collidoscope
