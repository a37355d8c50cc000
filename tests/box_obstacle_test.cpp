// Tests box obstacles against closed forms: distances, fast bodies that must not pass, rebounds, friction and
// weights.

#include <cmath>

#include "sim_cuda/solver/box_surface.h"
#include "tests/executors.h"
#include "tests/gravity.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

BoxSurface<double> surface(const Vector3d& center, const Vector3d& size, const Quaterniond& turn) {
  const Matrix3d m = turn.toRotationMatrix();
  return {center, size / 2, {m.col(0), m.col(1), m.col(2)}, 0, 0};
}

TEST(BoxSurface, IsNearestByFaceEdgeOrCorner) {
  const Quaterniond turn = Quaterniond(0.9, 0.1, -0.3, 0.2).normalized();
  const Vector3d center(3, -2, 1), half(1, 2, 3);
  const BoxSurface<double> box = surface(center, 2 * half, turn);
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        const Vector3d out(x, y, z);
        if (out.isZero()) continue;
        // A point on the face, edge or corner with these signs, moved outwards by 0.7 m.
        const Vector3d on(x == 0 ? 0.3 : x * half.x(), y == 0 ? -0.9 : y * half.y(),
                          z == 0 ? 0.4 : z * half.z());
        const Vector3d at = center + turn * Vector3d(on + 0.7 * out.normalized());
        const ContactPlane<double> plane = box.contact_plane_at(at);
        EXPECT_NEAR(box.gap(at, 0.5), 0.2, 1e-14);
        EXPECT_NEAR((plane.normal - turn * out.normalized()).norm(), 0, 1e-14);
        EXPECT_NEAR(plane.offset, plane.normal.dot(center + turn * on), 1e-14);
      }
  // Inside the box, the nearest face is 0.25 m away.
  for (const double side : {1.0, -1.0}) {
    const Vector3d inside = center + turn * Vector3d(0.3, side * 1.75, -0.6);
    EXPECT_NEAR(box.gap(inside, 0.5), -0.75, 1e-14);
    EXPECT_NEAR((box.contact_plane_at(inside).normal - turn * Vector3d(0, side, 0)).norm(), 0, 1e-14);
  }
}

TEST(BoxSurface, IsMetExactlyWhereTheWayMeetsTheGrownBox) {
  // The expected value comes from small steps along the path.
  Random random(3);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  int met = 0, missed = 0;
  for (int k = 0; k < 3000; ++k) {
    const BoxSurface<double> box =
        surface(Vector3d(0, 0, 0), Vector3d(uniform(0.1, 3), uniform(0.1, 3), uniform(0.1, 3)),
                Quaterniond(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized());
    const double r = uniform(0.05, 1);
    const Vector3d x(uniform(-4, 4), uniform(-4, 4), uniform(-4, 4)),
        displacement(uniform(-6, 6), uniform(-6, 6), uniform(-6, 6));
    if (box.gap(x, r) <= 0) continue;
    double least = 1e9, at = 2;
    for (int step = 1; step <= 2000; ++step) {
      const double gap = box.gap(x + step / 2000.0 * displacement, r);
      least = std::min(least, gap);
      if (gap <= 0 && at > 1) at = step / 2000.0;
    }
    const ContactPlane<double> plane = box.first_plane_on_path(x, displacement, r);
    if (at <= 1) {
      ++met;
      ASSERT_FALSE(plane.is_none()) << k;
      EXPECT_NEAR((plane.normal.dot(x + at * displacement) - plane.offset) / r, 1,
                  0.02 + displacement.norm() / 2000 / r)
          << k;
    } else if (least > 1e-3) {
      ++missed;
      EXPECT_TRUE(plane.is_none()) << k << ": it passes by " << least;
    }
  }
  EXPECT_GT(met, 150);
  EXPECT_GT(missed, 300);
}

class BoxObstacles : public OnEachExecutor {};
ON_EACH_EXECUTOR(BoxObstacles);

Scene with_box(const BoxObstacle& box) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = Precision::f64;
  scene.boxes = {box};
  return scene;
}

TEST_P(BoxObstacles, ABulletNeverPasses) {
  // The box is 0.1 m thick; 1,000 m/s is 8 m per substep.
  Random random(11);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const double e : {0.0, 0.7}) {
      Scene scene = with_box(
          {.size = Vector3d(4, 4, 0.1), .orientation = Quaterniond(0.8, 0.2, 0.5, 0.2).normalized()});
      scene.physics.precision = precision;
      scene.materials[0].restitution = e;
      const Vector3d axis = scene.boxes[0].orientation * Vector3d(0, 0, 1);
      for (int k = 0; k < 200; ++k) {
        Vector3d from(0, 0, 0);
        do
          for (int i = 0; i < 3; ++i) from[i] = uniform(-1, 1);
        while (from.norm() > 1 || std::abs(from.normalized().dot(axis)) < 0.05);
        const Vector3d target =
            scene.boxes[0].orientation * Vector3d(uniform(-1.5, 1.5), uniform(-1.5, 1.5), 0);
        const Vector3d start = target + uniform(5, 30) * from.normalized();
        scene.bodies = {sphere(0.02, start, -1000 * from.normalized())};
        World world(scene, options());
        const double side = from.dot(axis) > 0 ? 1 : -1;
        for (int step = 0; step < 3; ++step) {
          world.step();
          const BodyStates s = world.bodies();
          const Vector3d own = scene.boxes[0].orientation.conjugate() * s.position[0];
          EXPECT_GE(world.measure().max_penetration, 0);
          EXPECT_LT(world.measure().max_penetration, 1e-4) << k;
          // While the ball is above the box, it stays on the side from which it came.
          const bool over = std::abs(own.x()) < 2 && std::abs(own.y()) < 2;
          EXPECT_GT(over ? side * own.z() : 1, 0.05) << k << ' ' << step;
          EXPECT_GE(side * s.velocity[0].dot(axis), -1e-3) << k << ": it has been stopped";
        }
        const double through = -1000 * from.normalized().dot(axis) * side;
        // Steep bullets hit the face and not an edge.
        const double left = side * world.bodies().velocity[0].dot(axis);
        EXPECT_NEAR(-through > 300 ? left : -e * through, -e * through, 2e-4 * std::abs(through)) << k;
      }
    }
}

TEST_P(BoxObstacles, WhatPassesByIsNotTouched) {
  Scene scene = with_box({.size = Vector3d(2, 2, 2)});
  scene.bodies = {sphere(0.1, Vector3d(-30, 0, 1.2), Vector3d(500, 0, 0)),
                  sphere(0.1, Vector3d(-30, -32.3, 0), Vector3d(500, 500, 0)),
                  sphere(0.1, Vector3d(20, 1.15, 1.15), Vector3d(-700, 0, 0))};
  World world(scene, options());
  world.step(10);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(world.bodies().velocity[i], scene.bodies[i].velocity) << i;
}

TEST_P(BoxObstacles, BetweenBoxesNobodyGetsThrough) {
  // A wedge of two thin boxes with a box on either side and a lid. No body may leave it.
  Scene scene = with_box({.center = Vector3d(-1.2, 0, 0),
                          .size = Vector3d(0.1, 9, 8),
                          .orientation = Quaterniond(std::cos(0.2), 0, -std::sin(0.2), 0)});
  scene.boxes.push_back({.center = Vector3d(1.2, 0, 0),
                         .size = Vector3d(0.1, 9, 8),
                         .orientation = Quaterniond(std::cos(0.2), 0, std::sin(0.2), 0)});
  for (const double side : {1.0, -1.0})
    scene.boxes.push_back({.center = Vector3d(0, side * 4, 0), .size = Vector3d(9, 0.1, 9)});
  scene.physics.gravity = Vector3d(0, 0, -g);
  scene.materials[0].restitution = 0;
  Random random(2);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  for (int k = 0; k < 60; ++k)
    scene.bodies.push_back(sphere(0.15,
                                  Vector3d(0.3 * (k % 5 - 2) * 1.1, 0.5 * (k / 5 % 6 - 2.5), 1 + k / 30),
                                  Vector3d(uniform(-900, 900), uniform(-900, 900), -uniform(0, 900))));
  scene.boxes.push_back({.center = Vector3d(0, 0, 3.5), .size = Vector3d(9, 9, 0.1)});
  World world(scene, options());
  for (int step = 0; step < 200; ++step) {
    world.step();
    const BodyStates s = world.bodies();
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      const Vector3d x = s.position[i];
      ASSERT_TRUE(std::abs(x.y()) < 4 && x.z() < 3.5 && x.z() > -3.5) << i << " at " << x.transpose();
      ASSERT_LT(std::abs(x.x()), 1.2 + std::tan(0.4) * x.z()) << i << " at " << x.transpose();
    }
  }
  EXPECT_LT(world.measure().max_speed, 1);
  EXPECT_LT(world.measure().max_penetration, 0.02);
}

TEST_P(BoxObstacles, BearsAWeightByFaceEdgeAndGroove) {
  const double r = 0.5;
  Scene scene = with_box({.center = Vector3d(0, 0, -1), .size = Vector3d(4, 4, 2)});
  scene.physics.gravity = Vector3d(0, 0, -g);
  scene.materials[0].restitution = 0;
  scene.bodies = {sphere(r, Vector3d(0.3, 0.2, r + 0.05)), sphere(r, Vector3d(-1.2, -1, r))};
  World world(scene, options());
  world.step(60);
  const double before = world.measure().wall_impulse;
  world.step(30);
  double mass = world.initial().mass[0] + world.initial().mass[1];
  EXPECT_NEAR(world.measure().wall_impulse - before, mass * g, 1e-6 * mass * g) << "of one second";
  EXPECT_NEAR(world.bodies().position[0].z(), r, 1e-9);

  // Two boxes, 0.6 m apart: the ball rests in the gap, at sqrt(r^2 - 0.3^2) above the edges.
  scene.boxes = {{.center = Vector3d(-1.3, 0, -1), .size = Vector3d(2, 4, 2)},
                 {.center = Vector3d(1.3, 0, -1), .size = Vector3d(2, 4, 2)}};
  scene.bodies = {sphere(r, Vector3d(0, 0, r))};
  scene.physics.drag.viscosity = 50;
  World over(scene, options());
  over.step(300);
  EXPECT_NEAR(over.bodies().position[0].z(), std::sqrt(r * r - 0.09), 1e-3);
  EXPECT_NEAR(over.bodies().position[0].x(), 0, 1e-6);
}

TEST_P(BoxObstacles, RebondsAndRubsAsAPlaneDoes) {
  Scene flat = with_box({});
  flat.physics.gravity = Vector3d(0, 0, -g);
  flat.materials[0] = {.restitution = 0.6, .friction = 0.3, .rolling_resistance = 0.01};
  flat.bodies = {sphere(0.5, Vector3d(0, 0, 2), Vector3d(3, 0, 0))};
  Scene box = flat;
  flat.boxes.clear();
  const double angle = 0.3;
  const Vector3d normal(std::sin(angle), 0, std::cos(angle));
  flat.obstacles = {Plane{normal, 0, 0}};
  box.boxes = {{.center = 10 * Vector3d(std::cos(angle), 0, -std::sin(angle)) - normal,
                .size = Vector3d(40, 40, 2),
                .orientation = Quaterniond(std::cos(angle / 2), 0, std::sin(angle / 2), 0)}};
  World a(flat, options()), b(box, options());
  for (int step = 0; step < 120; ++step) {
    a.step();
    b.step();
    const BodyStates s = a.bodies(), t = b.bodies();
    EXPECT_NEAR((s.position[0] - t.position[0]).norm(), 0, 1e-9) << step;
    EXPECT_NEAR((s.velocity[0] - t.velocity[0]).norm(), 0, 1e-9) << step;
    EXPECT_NEAR((s.angular_velocity[0] - t.angular_velocity[0]).norm(), 0, 1e-9) << step;
  }
  EXPECT_NEAR(a.measure().wall_impulse, b.measure().wall_impulse, 1e-9 * a.measure().wall_impulse);
  EXPECT_GT(a.bodies().velocity[0].norm(), 5) << "it rolls down";
}

TEST_P(BoxObstacles, PushesOutWhatStartsInside) {
  Scene scene = with_box({.size = Vector3d(4, 6, 8)});
  scene.bodies = {sphere(0.5, Vector3d(1.5, 0, 1))};
  World world(scene, options());
  EXPECT_NEAR(world.measure().max_penetration, 1, 1e-12);
  world.step();
  EXPECT_NEAR((world.bodies().position[0] - Vector3d(2.5, 0, 1)).norm(), 0, 1e-12) << "by the nearest face";
  EXPECT_EQ(world.bodies().velocity[0], Vector3d(0, 0, 0));
}

TEST_P(BoxObstacles, AreRememberedAndCostNothingWhereThereAreNone) {
  Scene plain = box_collider(200);
  plain.generators[0].radius_max = 9;
  plain.physics.solver = Solver::soft_step;
  plain.materials[0].friction = 0.4;
  Scene on = plain;
  on.boxes = {{.center = Vector3d(50, 50, 10),
               .size = Vector3d(30, 50, 20),
               .orientation = Quaterniond(0.9, 0, 0, 0.4).normalized()}};
  World a(plain, options()), b(on, options());
  EXPECT_GT(b.info().allocated_bytes, a.info().allocated_bytes);
  a.step(60);
  b.step(60);
  const auto launches_of = [](World& world, const char* name) {
    for (const StageTime& stage : world.times().stages)
      if (stage.name == name) return stage.launches;
    return 0;
  };
  for (const char* stage : {"forces", "move", "bounce"})
    EXPECT_EQ(launches_of(a, stage) > 0, launches_of(b, stage) > 0) << stage;
  EXPECT_EQ(launches_of(a, "forces"), launches_of(b, "forces")) << "with the planes, in one";
  EXPECT_NE(a.state_hash(), b.state_hash());
  World first(on, options()), second(on, options());
  first.step(45);
  second.step(3);
  second.restore(first);
  second.step(15);
  EXPECT_EQ(second.state_hash(), b.state_hash());
}

}  // namespace
}  // namespace collidoscope
