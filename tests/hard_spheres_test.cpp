// Tests the event-driven reference against closed forms: two spheres, walls, bounces and their Zeno points.
// Also tests the scenes that it refuses.

#include "sim_cuda/reference/hard_spheres.h"

#include <gmock/gmock.h>

#include <cmath>

#include "sim_cuda/core/error.h"
#include "sim_cuda/reference/contact_time.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

void expect_near(const Vector3d& a, const Vector3d& b, double tolerance) {
  EXPECT_LE((a - b).lpNorm<Eigen::Infinity>(), tolerance) << a.transpose() << " is not " << b.transpose();
}
TEST(HardSpheres, TwoSpheresCollideByTheirClosedForm) {
  Uniform uniform{Random(9)};
  for (int k = 0; k < 200; ++k) {
    const double e = k % 2 ? 1 : uniform(0, 1);
    const Vector3d gravity = k % 3 ? uniform.vector(10) : Vector3d(0, 0, 0);
    Scene scene = hard_space(gravity, e);
    Body a = sphere(uniform(0.1, 2), uniform.vector(1), uniform.vector(3));
    Body b = sphere(uniform(0.1, 2), Vector3d(0, 0, 0), Vector3d(0, 0, 0));
    a.mass = uniform(0.1, 10);
    b.mass = uniform(0.1, 10);
    // Random parameters: the normal from b to a at impact, the closing velocity, and the time of impact.
    const double reach = a.radius + b.radius, impact = uniform(0.2, 2);
    const Vector3d normal = uniform.vector(1).normalized();
    Vector3d closing = uniform.vector(5);
    if (k % 5 == 0) closing = -3 * normal;  // head-on
    if (closing.dot(normal) > 0) closing = -closing;
    if (closing.dot(normal) > -0.3) continue;
    b.velocity = a.velocity - closing;
    b.position = a.position - reach * normal + closing * impact;  // d(impact) = reach normal
    scene.bodies = {a, b};

    HardSpheres exact(scene);
    const auto hit = exact.next_collision(10);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->body, 0u);
    EXPECT_EQ(hit->other, 1u);
    EXPECT_NEAR(hit->time, impact, 1e-12);
    expect_near(hit->normal, normal, 1e-12);
    const double impulse = -(1 + e) * closing.dot(normal) * *a.mass * *b.mass / (*a.mass + *b.mass);
    EXPECT_NEAR(hit->impulse, impulse, 1e-12 * impulse);
    ASSERT_TRUE(exact.advance_to(3));
    const BodyStates states = exact.bodies();
    const Vector3d change_a = impulse / *a.mass * normal, change_b = -impulse / *b.mass * normal;
    const double after = 3 - impact;
    expect_near(states.velocity[0], a.velocity + change_a + 3 * gravity, 1e-12 * (1 + change_a.norm()));
    expect_near(states.velocity[1], b.velocity + change_b + 3 * gravity, 1e-12 * (1 + change_b.norm()));
    expect_near(states.position[0], a.position + 3 * a.velocity + after * change_a + 4.5 * gravity, 1e-11);
    expect_near(states.position[1], b.position + 3 * b.velocity + after * change_b + 4.5 * gravity, 1e-11);
    EXPECT_FALSE(exact.next_collision(never));
    EXPECT_EQ(exact.counts().pairs, 1);
    EXPECT_NEAR(exact.dissipated(), (1 - e) / (1 + e) * impulse * impulse / 2 * (1 / *a.mass + 1 / *b.mass),
                1e-12 * impulse * impulse);
  }
}

TEST(HardSpheres, ARowThatTouchesPassesTheImpactOnAtOnce) {
  Scene scene = hard_space();
  for (int i = 0; i < 5; ++i) scene.bodies.push_back(sphere(0.5, Vector3d(i, 0, 0)));
  scene.bodies.push_back(sphere(0.5, Vector3d(-3, 0, 0), Vector3d(2, 0, 0)));
  HardSpheres exact(scene);
  for (const double time : {1.0, 1.0, 1.0, 1.0, 1.0}) EXPECT_EQ(exact.next_collision(9)->time, time);
  EXPECT_FALSE(exact.next_collision(9));
  const BodyStates states = exact.bodies();
  for (int i = 0; i < 4; ++i) EXPECT_EQ(states.velocity[i], Vector3d(0, 0, 0));
  EXPECT_EQ(states.velocity[4], Vector3d(2, 0, 0));
  EXPECT_EQ(states.position[4], Vector3d(4 + 16, 0, 0));
  EXPECT_EQ(states.velocity[5], Vector3d(0, 0, 0));
}

TEST(HardSpheres, BetweenWallsPositionIsAFoldedLine) {
  Scene scene = hard_space();
  scene.box = Box{Vector3d(-1, 2, 3), Vector3d(4, 4, 7)};
  scene.bodies = {sphere(0.25, Vector3d(0.1, 3.1, 5.7), Vector3d(1.7, -2.3, 0.9))};
  HardSpheres exact(scene);
  const double time = 50;
  ASSERT_TRUE(exact.advance_to(time));
  EXPECT_GT(exact.counts().planes, 100);
  for (int k = 0; k < 3; ++k) {
    const double low = scene.box->min[k] + 0.25, room = scene.box->max[k] - 0.25 - low;
    const double way =
        std::fmod(scene.bodies[0].position[k] + scene.bodies[0].velocity[k] * time - low, 2 * room);
    const double folded = way < 0 ? way + 2 * room : way;
    EXPECT_NEAR(exact.bodies().position[0][k], low + std::min(folded, 2 * room - folded), 1e-12);
  }
}

TEST(HardSpheres, OffATiltedPlaneItLeavesAsAMirrorSays) {
  const Vector3d normal = Vector3d(1, 2, 3).normalized(), gravity(0.3, -0.7, -9.81), start(3, 2, 4);
  Scene scene = hard_space(gravity, 0.7);
  scene.obstacles = {Plane{normal, 0.4, 0}};
  scene.bodies = {sphere(0.5, start, Vector3d(1, -1, 0.5))};
  HardSpheres exact(scene);
  const auto hit = exact.next_collision(9);
  ASSERT_TRUE(hit);
  const double gap = normal.dot(start) - 0.9, speed = normal.dot(Vector3d(1, -1, 0.5)),
               pull = normal.dot(gravity);
  const double impact = (-speed - std::sqrt(speed * speed - 2 * pull * gap)) / pull;
  EXPECT_NEAR(hit->time, impact, 1e-12);
  const Vector3d before = Vector3d(1, -1, 0.5) + impact * gravity;
  expect_near(exact.bodies().velocity[0], before - 1.7 * normal.dot(before) * normal, 1e-12);
  EXPECT_NEAR(exact.measure().wall_impulse, -1.7 * normal.dot(before) * exact.initial().mass[0],
              1e-12 * exact.measure().wall_impulse);
}

/// A ball dropped from `height` above the floor.
Scene dropped(double height, double e) {
  Scene scene = hard_space(Vector3d(0, 0, -9.81), e);
  scene.obstacles = {Plane{Vector3d(0, 0, 1), -2, 0}};
  scene.bodies = {sphere(0.3, Vector3d(0.7, 0, -1.7 + height), Vector3d(0.25, 0, 0))};
  return scene;
}

TEST(HardSpheres, ABouncingBallRisesToESquaredOfItsHeight) {
  for (const double e : {0.5, 0.8, 0.9, 1.0}) {
    const double h = 1.3, g = 9.81, fall = std::sqrt(2 * h / g);
    HardSpheres exact(dropped(h, e));
    double bounce = fall, height = h;
    for (int k = 0; k < 20; ++k) {
      height *= e * e;
      const double rise = std::sqrt(2 * height / g);
      ASSERT_TRUE(exact.advance_to(bounce + rise));
      EXPECT_EQ(exact.counts().planes, k + 1);
      EXPECT_NEAR(exact.bodies().position[0].z(), -1.7 + height, 1e-12);
      EXPECT_NEAR(exact.bodies().position[0].x(), 0.7 + 0.25 * exact.time(), 1e-12);
      EXPECT_NEAR(exact.bodies().velocity[0].z(), 0, 1e-12 * g);
      bounce += 2 * rise;
    }
  }
}

TEST(HardSpheres, AnElasticBallKeepsItsHeightAndItsFloorForTenThousandBounces) {
  HardSpheres exact(dropped(1.3, 1));
  for (int k = 0; k < 10000; ++k) {
    ASSERT_TRUE(exact.next_collision(never));
    ASSERT_NEAR(exact.bodies().position[0].z(), -1.7, 1e-15);
    ASSERT_NEAR(exact.bodies().velocity[0].z(), std::sqrt(2 * 9.81 * 1.3), 1e-14);
  }
  EXPECT_NEAR(exact.time(), 19999 * std::sqrt(2 * 1.3 / 9.81), 1e-12 * exact.time());
}

TEST(HardSpheres, CountTheDigitsOfPi) {
  // Galperin 2003: a ball between a wall and a ball 100^d times as heavy has floor(10^d pi) collisions.
  const int digits[] = {3, 31, 314, 3141, 31415};
  for (int d = 0; d < 5; ++d) {
    Scene scene = hard_space();
    scene.obstacles = {Plane{Vector3d(1, 0, 0), 0, 0}};
    scene.bodies = {sphere(0.5, Vector3d(2, 0, 0)), sphere(0.5, Vector3d(4, 0, 0), Vector3d(-1, 0, 0))};
    scene.bodies[0].mass = 1;
    scene.bodies[1].mass = std::pow(100.0, d);
    HardSpheres exact(scene);
    while (exact.next_collision(never)) {
    }
    EXPECT_EQ(exact.counts().pairs + exact.counts().planes, digits[d]);
  }
}

// ---- Zeno points ----

TEST(ZenoPoint, OfABouncingBallIsAtItsClosedForm) {
  for (const double e : {0.0, 0.1, 0.5, 0.8, 0.9, 0.99, 0.999}) {
    const double fall = std::sqrt(2 * 1.3 / 9.81), zeno = fall * (1 + e) / (1 - e);
    HardSpheres exact(dropped(1.3, e));
    EXPECT_TRUE(exact.advance_to(zeno * (1 - 1e-9)));
    EXPECT_EQ(exact.zeno_line(), "");
    EXPECT_FALSE(exact.advance_to(2 * zeno)) << e;
    ASSERT_TRUE(exact.zeno_point()) << e;
    EXPECT_NEAR(exact.time(), zeno, 1e-12 * zeno) << e;
    EXPECT_EQ(exact.time(), exact.zeno_point()->time);
    EXPECT_NEAR(exact.bodies().position[0].z(), -1.7, 1e-12);
    EXPECT_NEAR(exact.dissipated(), exact.initial().mass[0] * 9.81 * 1.3, 1e-12 * exact.dissipated());
    EXPECT_FALSE(exact.next_collision(never));
    EXPECT_THAT(exact.zeno_line(), testing::StartsWith("Zeno point at "));
    EXPECT_THAT(exact.zeno_line(), testing::EndsWith(" s: body 0 comes to rest on plane 0 of the obstacles"));
  }
}

TEST(ZenoPoint, IsAtOnceWhereABodyLiesOnTheFloorEvenAnElasticOne) {
  Scene scene = hard_space(Vector3d(0, 0, -9.81));
  scene.box = Box{};
  scene.bodies = {sphere(1, Vector3d(9, 9, 20)), sphere(1, Vector3d(50, 50, 1), Vector3d(1, 0, 0))};
  HardSpheres exact(scene);
  EXPECT_FALSE(exact.advance_to(1));
  EXPECT_EQ(exact.time(), 0);
  EXPECT_EQ(exact.zeno_line(), "Zeno point at 0 s: body 1 comes to rest on the wall z = 0");
}

TEST(ZenoPoint, OfThreeBallsInARowIsBelowTheKnownRestitution) {
  // McNamara, Young 1992: three equal balls on a line collapse exactly for e < 7 - 4 sqrt(3) = 0.0718.
  const double known = 7 - 4 * std::sqrt(3.0);
  for (const double e : {0.0, 0.02, 0.05, known - 1e-3, known + 1e-3, 0.1, 0.5}) {
    Scene scene = hard_space(Vector3d(0, 0, 0), e);
    // The middle ball is at rest. The two impacts differ slightly in time.
    scene.bodies = {sphere(0.5, Vector3d(-2, 0, 0), Vector3d(1, 0, 0)), sphere(0.5, Vector3d(0, 0, 0)),
                    sphere(0.5, Vector3d(2.001, 0, 0), Vector3d(-1, 0, 0))};
    HardSpheres exact(scene);
    EXPECT_EQ(exact.advance_to(10), e > known) << e << ": " << exact.counts().pairs;
    if (e < known) {
      EXPECT_THAT(exact.zeno_line(), testing::HasSubstr("infinitely many collisions of bodies"));
    }
  }
}

TEST(ZenoPoint, IsFoundWhereABodyRattlesBetweenSeveral) {
  // In a groove the ball hits the two planes alternately. The other scene has bodies on the floor below
  // others.
  for (const double e : {0.3, 0.5, 0.9, 0.99}) {
    Scene groove = hard_space(Vector3d(0, 0, -9.81), e);
    groove.obstacles = {Plane{Vector3d(1, 0, 1).normalized(), 0, 0},
                        Plane{Vector3d(-1, 0, 2).normalized(), 0, 0}};
    groove.bodies = {sphere(0.5, Vector3d(0.3, 7, 4), Vector3d(0.1, 3, 0))};
    Scene column = hard_space(Vector3d(0, 0, -9.81), e);
    column.obstacles = {Plane{Vector3d(0, 0, 1), 0, 0}};
    for (int k = 0; k < 5; ++k) column.bodies.push_back(sphere(0.5, Vector3d(0, 0, 1 + 1.3 * k)));
    for (const Scene& scene : {groove, column}) {
      HardSpheres exact(scene);
      const double energy = exact.measure().energy();
      EXPECT_FALSE(exact.advance_to(1000)) << e;
      EXPECT_LT(exact.counts().pairs + exact.counts().planes, 10000);
      EXPECT_NEAR(exact.measure().energy() + exact.dissipated(), energy, 1e-12 * energy);
    }
  }
}

TEST(ZenoPoint, HundredsOfCollisionsCloseInTimeAreNone) {
  // A light ball between a wall and a heavy ball with a small loss per bounce, so the motion continues.
  Scene scene = hard_space(Vector3d(0, 0, 0), 0.9999);
  scene.obstacles = {Plane{Vector3d(1, 0, 0), 0, 0}};
  scene.bodies = {sphere(0.5, Vector3d(2, 0, 0)), sphere(0.5, Vector3d(4, 0, 0), Vector3d(-1, 0, 0))};
  scene.bodies[0].mass = 1;
  scene.bodies[1].mass = 1e4;
  HardSpheres exact(scene);
  EXPECT_TRUE(exact.advance_to(100)) << exact.zeno_line();
  EXPECT_GT(exact.counts().pairs + exact.counts().planes, 300);
  EXPECT_GT(exact.bodies().velocity[1].x(), 0.5);
}

TEST(ZenoPoint, TwoThatStickTogetherAreNone) {
  // One collision, then the bodies move side by side with rounding errors only.
  Uniform uniform{Random(2)};
  for (int k = 0; k < 100; ++k) {
    Scene scene = hard_space(Vector3d(0, 0, -9.81), 0);
    scene.bodies = {sphere(0.5, Vector3d(0, 0, 0), uniform.vector(3)), sphere(0.7, Vector3d(0, 0, 0))};
    scene.bodies[1].position = uniform.vector(5).normalized() * 2;
    scene.bodies[1].velocity = scene.bodies[0].velocity - scene.bodies[1].position;
    HardSpheres exact(scene);
    EXPECT_TRUE(exact.advance_to(100));
    EXPECT_GE(exact.counts().pairs, 1);
    EXPECT_LT(exact.counts().pairs, 100);
    EXPECT_LT(exact.measure().max_penetration, 1e-10);
  }
}
// ---- unsupported scenes ----

std::string refusal(const Scene& scene) {
  try {
    HardSpheres exact(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(HardSpheres, RefuseWhatTheyDoNotKnowInALineEach) {
  const std::string head =
      "test: the event-driven reference supports only spheres, planes, gravity and restitution, not ";
  Scene plain = hard_space();
  plain.bodies = {sphere(1, Vector3d(0, 0, 0)), sphere(1, Vector3d(5, 0, 0))};
  EXPECT_EQ(refusal(plain), "none");

  Scene scene = plain;
  scene.physics.attractors = {{}, {}};
  scene.physics.attractors[0].strength = scene.physics.attractors[1].strength = 1;
  scene.physics.drag.viscosity = 2;
  EXPECT_EQ(refusal(scene),
            head + "attractor (2 attractors)\n" + head + "drag (the medium's viscosity is 2 Pa s)");
  scene.physics.effects = Effects{};  // attractors and drag are switched off
  EXPECT_EQ(refusal(scene), "none");

  scene = plain;
  scene.materials[0].friction = 0.5;
  EXPECT_EQ(refusal(scene), head + "rotation (friction applies torques)\n" + head +
                                "friction (the material \"default\" has friction 0.5)");
  scene = plain;
  scene.physics.effects = Effects{.rotation = true};
  EXPECT_EQ(refusal(scene), head + "rotation (in the scene's list of effects)");
  scene = plain;
  scene.boxes = {{}};
  scene.boxes[0].center = Vector3d(9, 9, 9);
  EXPECT_EQ(refusal(scene), head + "box obstacles");
  scene = plain;
  scene.bodies[1].motion = Motion::fixed;
  EXPECT_EQ(refusal(scene), head + "static or kinematic bodies (body 1)");
  scene = plain;
  scene.bodies[1].position = Vector3d(1.5, 0, 0);
  EXPECT_EQ(
      refusal(scene),
      "test: bodies 0 and 1 overlap by 0.5 m at the start; hard spheres must not overlap (spawn \"apart\")");
  scene = plain;
  scene.obstacles = {Plane{Vector3d(0, 0, 1), -0.75, 0}};
  scene.bodies.pop_back();
  EXPECT_EQ(refusal(scene),
            "test: body 0 is behind plane 0 by 0.25 m at the start; hard spheres must not overlap (spawn "
            "\"apart\")");
  scene = box_collider(10, Variant::settled);
  scene.materials[0].restitution = 1;
  EXPECT_THAT(refusal(scene),
              testing::HasSubstr("not piles at rest (variant settled): infinitely many collisions"));
}

TEST(HardSpheres, OfWhichThereAreNoneJustLetTimePass) {
  HardSpheres exact(hard_space());
  EXPECT_TRUE(exact.advance_to(3));
  EXPECT_EQ(exact.time(), 3);
  EXPECT_EQ(exact.measure().energy(), 0);
  EXPECT_THROW(exact.advance_to(2), std::logic_error);
}

TEST(HardSpheres, SlowApproachesDoNotBounceBelowTheThreshold) {
  Scene scene = hard_space();
  scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(1, 0, 0)), sphere(1, Vector3d(3, 0, 0))};
  for (const double threshold : {0.5, 2.0}) {
    scene.physics.restitution_threshold = threshold;
    HardSpheres exact(scene);
    exact.advance_to(2);
    EXPECT_NEAR(exact.bodies().velocity[1].x(), threshold < 1 ? 1 : 0.5, 1e-15);
  }
}

TEST(HardSpheres, APairTakesTheLargerRestitution) {
  Scene scene = hard_space(Vector3d(0, 0, 0), 0.25);
  scene.materials.push_back({.name = "rubber", .restitution = 0.75});
  scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(1, 0, 0)), sphere(1, Vector3d(3, 0, 0))};
  scene.bodies[1].material = 1;
  scene.obstacles = {Plane{Vector3d(-1, 0, 0), -9, 0}};  // x <= 9
  HardSpheres exact(scene);
  exact.advance_to(2);
  expect_near(exact.bodies().velocity[1] - exact.bodies().velocity[0], Vector3d(0.75, 0, 0), 1e-15);
  exact.advance_to(9);
  EXPECT_NEAR(exact.bodies().velocity[1].x(), -0.875 * 0.75, 1e-15);
  EXPECT_EQ(exact.counts().planes, 1);
}

}  // namespace
}  // namespace collidoscope
