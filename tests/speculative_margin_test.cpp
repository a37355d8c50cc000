// Tests that bodies which meet in a step have a predicted contact.

#include <gtest/gtest.h>

#include <algorithm>

#include "sim_cuda/dynamics/bounds.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

enum class Predicted { smooth, drag, stop, rebound };

template <Predicted kind>
void expect_predicted() {
  // Each body moves in K substeps of semi-implicit Euler. Its acceleration is gravity, minus part of it for a
  // frictionless support, with drag. An impact may stop the first body, or reverse its initial velocity.
  // Bodies in contact at some substep must have a predicted contact, by boxes and by gap.
  constexpr bool with_drag = kind == Predicted::drag, rebounds = kind == Predicted::rebound,
                 with_impact = rebounds || kind == Predicted::stop;
  Random random(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  const auto direction = [&] {
    Vector3d d(0, 0, 0);
    do
      for (int k = 0; k < 3; ++k) d[k] = uniform(-1, 1);
    while (d.squaredNorm() > 1 || d.squaredNorm() < 1e-4);
    return Vector3d(d.normalized());
  };
  const Vector3d g(1, -2, -9.81);
  int met = 0;
  for (int round = 0; round < 20000; ++round) {
    const double dt = uniform(0.001, 0.1);
    const int substeps = 1 + static_cast<int>(random() % 8);
    struct Moving {
      Vector3d x, v, pull;
      double r, viscosity;
    } body[2];
    for (Moving& m : body) {
      const Vector3d support = direction();
      const double pressed = std::max(0.0, -g.dot(support));
      m = {Vector3d(0, 0, 0), uniform(0, 30) * direction(), g + pressed * support, uniform(0.01, 1),
           with_drag ? uniform(0, 3) / dt : 0};
      if (random() % 3 == 0) m.pull = g;
    }
    body[1].x = (body[0].r + body[1].r + uniform(0, 1.5) * dt * 30) * direction();
    const double e = rebounds ? uniform(0, 1) : 0;
    if (with_impact && random() % 2 == 0) body[1].v = body[0].v + uniform(0, 1) * direction();
    const int impact = with_impact ? static_cast<int>(random() % static_cast<unsigned>(substeps)) : substeps;
    const Vector3d lost = uniform(1, 1 + e) * body[0].v;
    const Vector3d x[2] = {body[0].x, body[1].x}, v[2] = {body[0].v, body[1].v};
    const double r[2] = {body[0].r, body[1].r};
    bool meet = false;
    for (int k = 0; k < substeps; ++k) {
      if (k == impact) body[0].v -= lost;
      for (Moving& m : body) {
        m.v = (m.v + dt / substeps * m.pull) / (1 + dt / substeps * m.viscosity);
        m.x += dt / substeps * m.v;
      }
      meet = meet || (body[1].x - body[0].x).norm() <= r[0] + r[1];
    }
    if (!meet) continue;
    ++met;
    constexpr MotionBound bound = with_drag ? MotionBound::linear_with_drag : MotionBound::linear;
    const PackedVector3<double> stored[2] = {v[0], v[1]};
    const SpeculativeMargin<double> margin{bound, stored, dt, dt * dt * g.norm(), e};
    EXPECT_TRUE(spheres_will_touch<double>(x[0], r[0], v[0], x[1], r[1], v[1], margin));
    Aabb boxes[2];
    const SweptBounds<double> bounds{
        x, stored, r, boxes, {1 + nearly_touching, dt, margin.acceleration_margin, e}};
    bounds(0);
    bounds(1);
    EXPECT_TRUE(overlap(boxes[0], boxes[1]));
  }
  EXPECT_GT(met, 500);
}

TEST(SpeculativeMargin, MissesNoContactOfASmoothMotion) { expect_predicted<Predicted::smooth>(); }
TEST(SpeculativeMargin, MissesNoneWhereDragStopsOneOfTwo) { expect_predicted<Predicted::drag>(); }
TEST(SpeculativeMargin, MissesNoneWhereAnImpactStopsOneOfTwo) { expect_predicted<Predicted::stop>(); }
TEST(SpeculativeMargin, MissesNoneWhereOneOfTwoRebounds) { expect_predicted<Predicted::rebound>(); }

}  // namespace
}  // namespace collidoscope
