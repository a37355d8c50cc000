// Tests hinges, chains and joints that contradict each other: momenta, limits, stretch below a load, and
// bounded speeds.

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "sim_cuda/scene/joint_substeps.h"
#include "sim_cuda/scene/joint_trees.h"
#include "tests/executors.h"
#include "tests/gravity.h"
#include "tests/joint_scenes.h"

namespace collidoscope {
namespace {

using std::numbers::pi;

class JointedChains : public OnEachExecutor {};
ON_EACH_EXECUTOR(JointedChains);

/// Two non-spherical bodies that tumble, with an anchor beside both centres.
Scene tumbling(JointKind kind) {
  Scene scene = joint_space(0);
  scene.bodies = {sphere(0.5, Vector3d(0, 0, 0), Vector3d(0.2, 0.1, 0.3)),
                  sphere(0.5, Vector3d(1, 0, 0), Vector3d(0.2, 0.1, 0.3))};
  scene.bodies[0].mass = 2;
  scene.bodies[0].inertia = Vector3d(0.1, 0.2, 0.25);
  scene.bodies[1].mass = 1;
  scene.bodies[1].inertia = Vector3d(0.2, 0.1, 0.15);
  scene.bodies[1].orientation = Quaterniond(0.8, 0.6, 0, 0);
  for (Body& body : scene.bodies) body.angular_velocity = Vector3d(1, 3, -2);
  scene.bodies[1].velocity += Vector3d(1, 3, -2).cross(Vector3d(1, 0, 0));  // initially a common rigid motion
  scene.bodies[1].angular_velocity += Vector3d(0, 0, 4);
  const Vector3d anchor(0.5, 0.1, 0);
  scene.bodies[1].velocity -= Vector3d(0, 0, 4).cross(anchor - Vector3d(1, 0, 0));
  Joint joint = joint_between(kind, 0, 1);
  joint.anchor_a = anchor;
  scene.joints = {joint};
  return scene;
}

struct Kept {
  double momentum, energy, error, angle;  ///< the largest change, the last two absolute
};

Kept kept_by(const Scene& scene, int steps, const RunOptions& options) {
  World world(scene, options);
  const StepStats first = world.measure();
  Kept kept{};
  for (int k = 0; k < steps; ++k) {
    world.step();
    const StepStats now = world.measure();
    for (int axis = 0; axis < 3; ++axis) {
      kept.momentum = std::max(kept.momentum, std::abs(now.momentum[axis] - first.momentum[axis]));
      kept.momentum =
          std::max(kept.momentum, std::abs(now.angular_momentum[axis] - first.angular_momentum[axis]));
    }
    kept.energy = std::max(kept.energy, std::abs(now.energy() / first.energy() - 1));
    kept.error = std::max(kept.error, now.max_joint_error);
    kept.angle = std::max(kept.angle, now.max_joint_angle);
  }
  return kept;
}

TEST_P(JointedChains, ATumblingPairKeepsItsMomentaAndItsAnchors) {
  for (const JointKind kind : {JointKind::distance, JointKind::ball, JointKind::hinge}) {
    Scene scene = tumbling(kind);
    if (kind == JointKind::distance) {
      scene.joints[0].anchor_b = Vector3d(-0.3, 0.2, 0.1);
      scene.joints[0].max_length = 0.8;
    }
    const Kept kept = kept_by(scene, 300, options());
    EXPECT_LT(kept.momentum, 1e-12) << "to rounding";
    // The joint is solved for the spin at the start of a substep, which gyroscopic torques then change: an
    // error of second order.
    EXPECT_LT(kept.error, 6e-5);
    EXPECT_LT(kept.angle, 1e-3);
    if (kind != JointKind::distance) {  // a taut rope is inelastic
      EXPECT_LT(kept.energy, 1e-3);
    }
    scene.physics.substeps = 16;
    const Kept finer = kept_by(scene, 300, options());
    EXPECT_LT(finer.error, 4e-6);
    EXPECT_LT(finer.angle, 1e-4);
    if (kind != JointKind::distance) {
      EXPECT_LT(finer.energy, 1e-4);
    }
    EXPECT_LT(finer.momentum, 1e-12);
    scene.physics.precision = Precision::f32;
    const Kept rough = kept_by(scene, 300, options());
    EXPECT_LT(rough.momentum, 3e-3) << "of some 10, over 4,800 substeps";
    EXPECT_LT(rough.error, 1e-5);
    scene.physics = tumbling(kind).physics;
    scene.physics.rotation_update = RotationUpdate::first_order;
    EXPECT_LT(kept_by(scene, 300, options()).error, 1e-5) << "first_order rotates about that spin";
  }
}

TEST_P(JointedChains, AFreeHingeKeepsTheAngularMomentumAboutItsAxis) {
  // Two wheels on one axle: each keeps its angular momentum about it.
  Scene scene = joint_space(0);
  scene.bodies = {sphere(0.5, Vector3d(0, 0, -0.6)), sphere(0.5, Vector3d(0, 0, 0.6))};
  scene.bodies[0].angular_velocity = Vector3d(0, 0, 5);
  scene.bodies[1].angular_velocity = Vector3d(0, 0, -3);
  scene.joints = {joint_between(JointKind::hinge, 0, 1)};
  scene.joints[0].anchor_a = Vector3d(0, 0, 0.6);
  World world(scene, options());
  world.step(600);
  const BodyStates s = world.bodies();
  EXPECT_NEAR((s.angular_velocity[0] - Vector3d(0, 0, 5)).norm(), 0, 1e-12);
  EXPECT_NEAR((s.angular_velocity[1] - Vector3d(0, 0, -3)).norm(), 0, 1e-12);
  EXPECT_LT(world.measure().max_joint_angle, 1e-12);
}

/// A sphere on a hinge along y through its centre. The other side is the world. The sphere spins at `spin`.
Scene hinged(double spin, const std::optional<std::array<double, 2>>& limits) {
  Scene scene = joint_space(0);
  scene.bodies = {sphere(0.5, Vector3d(1, 2, 3))};
  scene.bodies[0].angular_velocity = Vector3d(0, spin, 0);
  Joint hinge;
  hinge.kind = JointKind::hinge;
  hinge.a = 0;
  hinge.axis = Vector3d(0, 1, 0);
  hinge.limits = limits;
  scene.joints = {hinge};
  return scene;
}

double angle_about_y(const Quaterniond& q) { return 2 * std::atan2(q.y(), q.w()); }

TEST_P(JointedChains, AHingeStopsAtItsLimits) {
  // The limits apply to b, here the world, relative to a. Body a rotates the opposite way.
  for (const double spin : {-7.0, -0.9, 0.4, 5.0})
    for (const double limit : {1.0, 45.0, 90.0, 170.0}) {
      World world(hinged(spin, std::array{-limit, limit / 2}), options());
      world.step(4000 / static_cast<int>(std::ceil(std::abs(spin))));
      const double expected = (spin > 0 ? limit : -limit / 2) * pi / 180;
      EXPECT_NEAR(angle_about_y(world.bodies().orientation[0]), expected, 1e-6) << spin << ' ' << limit;
      EXPECT_LT(world.bodies().angular_velocity[0].norm(), 1e-6);
      EXPECT_LT(world.measure().max_joint_angle, 1e-6);
    }
}

TEST_P(JointedChains, AHingeTurnsOnlyAboutItsAxis) {
  Scene scene = hinged(2, {});
  scene.bodies[0].angular_velocity = Vector3d(3, 2, -1);
  World world(scene, options());
  for (int k = 0; k < 120; ++k) {
    world.step();
    const Vector3d axis = world.bodies().orientation[0] * Vector3d(0, 1, 0);
    EXPECT_NEAR((axis - Vector3d(0, 1, 0)).norm(), 0, 1e-9);
    EXPECT_NEAR(world.bodies().angular_velocity[0].y(), 2, 1e-9) << "about it, nothing holds";
    EXPECT_NEAR((world.bodies().position[0] - Vector3d(1, 2, 3)).norm(), 0, 1e-12);
  }
}

/// Fifty links of 1 m, the last with 1,000 times the mass, released horizontally or hanging down.
Scene chain(JointKind kind, bool to_the_side, double ratio) {
  Scene scene = joint_space(g, Precision::f32);
  const Vector3d link = to_the_side ? Vector3d(1, 0, 0) : Vector3d(0, 0, -1);
  for (int i = 0; i < 50; ++i) {
    scene.bodies.push_back(sphere(0.4, (i + 1) * link));
    scene.bodies.back().mass = i == 49 ? ratio : 1;
    Joint joint = i == 0 ? joint_to_world(kind, 0, Vector3d(0, 0, 0)) : joint_between(kind, i, i - 1);
    if (kind == JointKind::ball) {
      joint.anchor_a = -link / 2;
      joint.anchor_b = link / 2;
    }
    scene.joints.push_back(joint);
  }
  return scene;
}

/// Adds slack ropes from each body to the world: more loops than are solved directly, so that all joints are
/// iterated.
Scene looped(Scene scene) {
  const int bodies = static_cast<int>(scene.bodies.size());
  for (int k = 0; k < bodies * (1 + JointTrees::max_closing_rows / bodies); ++k) {
    Joint rope = joint_to_world(JointKind::distance, k % bodies, Vector3d(0, 0, 0));
    rope.max_length = 1e4;
    scene.joints.push_back(rope);
  }
  return scene;
}

struct Stretch {
  double chain = 0, joint = 0;  ///< largest: of the chain, relative; of a joint, m
};

Stretch stretch_of(const Scene& scene, const RunOptions& options) {
  World world(scene, options);
  Stretch largest;
  for (int k = 0; k < 240; ++k) {
    world.step();
    const BodyStates s = world.bodies();
    double length = s.position[0].norm();
    for (std::size_t i = 1; i < 50; ++i) length += (s.position[i] - s.position[i - 1]).norm();
    largest.chain = std::max(largest.chain, length / 50 - 1);
    largest.joint = std::max(largest.joint, world.measure().max_joint_error);
  }
  return largest;
}

TEST_P(JointedChains, AChainOf50BelowALoadKeepsItsLength) {
  for (const JointKind kind : {JointKind::distance, JointKind::ball})
    for (const bool to_the_side : {false, true})
      for (const double ratio : {1e3, to_the_side ? 1e4 : 1e6}) {
        const Scene scene = chain(kind, to_the_side, ratio);
        EXPECT_EQ(substeps_of(scene, initial_bodies(scene)), 4);
        const Stretch stretch = stretch_of(scene, options());
        EXPECT_LT(stretch.chain, 1e-6) << ratio << ' ' << to_the_side;
        EXPECT_LT(stretch.joint, 2e-5) << "rounding of float at 50 m";
      }
}

TEST_P(JointedChains, AnIteratedChainOf50StretchesUnder2PercentBelow1000TimesItsMass) {
  for (const bool to_the_side : {false, true}) {
    const Scene scene = looped(chain(JointKind::distance, to_the_side, 1000));
    EXPECT_EQ(substeps_of(scene, initial_bodies(scene)), 21);
    const Stretch stretch = stretch_of(scene, options());
    EXPECT_LT(stretch.chain, 0.02) << to_the_side;
    EXPECT_LT(stretch.joint, 0.04) << "no link of 1 m, either";
  }
}

TEST_P(JointedChains, AHangingLoadRests) {
  Scene scene = chain(JointKind::distance, false, 200);
  scene.bodies.erase(scene.bodies.begin(), scene.bodies.begin() + 45);
  scene.joints.resize(5);
  for (int i = 0; i < 5; ++i) scene.bodies[static_cast<std::size_t>(i)].position.z() = -(i + 1);
  scene.physics.substeps = 16;
  World tree(scene, options());
  tree.step(3000);
  EXPECT_LT(tree.measure().max_joint_error, 2e-6) << "joints of a tree do not yield";
  World iterated(looped(scene), options());
  iterated.step(3000);
  EXPECT_LT(iterated.measure().max_joint_error, 2e-4);
  EXPECT_LT(iterated.measure().max_speed, 1e-3);
}

TEST(JointSubsteps, AreAsManyAsTheLoadCallsFor) {
  const auto of = [](const Scene& scene) { return substeps_of(scene, initial_bodies(scene)); };
  EXPECT_EQ(of(chain(JointKind::distance, false, 1000)), 4) << "joints of a tree do not yield";
  Scene scene = looped(chain(JointKind::distance, false, 1000));
  // Three joints at a body: the stretch is 3 F h^2 / (4 m) with m = 1/2 kg, at most 1 % of 1 m.
  const double load = (49 + 1000) * g, h = std::sqrt(0.01 * 4 * 0.5 / (3 * load));
  EXPECT_EQ(of(scene), static_cast<int>(std::ceil(1 / (60 * h))));
  scene.physics.time_step = scene.physics.time_step / 2;
  EXPECT_EQ(of(scene), static_cast<int>(std::ceil(1 / (120 * h))));
  scene.physics.substeps = 3;
  EXPECT_EQ(of(scene), 3);
  EXPECT_EQ(substeps_missed(scene, initial_bodies(scene)), 0) << "the number is set";
  scene.physics.substeps.reset();
  scene.bodies[49].mass = 1e12;
  EXPECT_EQ(of(scene), 64) << "and no more";
  EXPECT_NEAR(substeps_missed(scene, initial_bodies(scene)),
              std::ceil(1 / (120 * h) * std::sqrt(1e12 / 1049)), 1e-3 / (120 * h) * std::sqrt(1e12 / 1049));
  scene.physics.gravity.setZero();
  EXPECT_EQ(of(scene), 4) << "nothing hangs";
  EXPECT_EQ(substeps_missed(scene, initial_bodies(scene)), 0);
  scene = chain(JointKind::distance, false, 1);
  scene.joints.clear();
  scene.physics.solver = Solver::impulse;
  EXPECT_EQ(of(scene), 1);
}

TEST_P(JointedChains, LoopsAndRedundantJointsStayFinite) {
  Scene scene = joint_space(g, Precision::f32);
  for (int i = 0; i < 4; ++i)
    scene.bodies.push_back(sphere(0.3, Vector3d(i % 2 == 0 ? 0 : 1, 0, i < 2 ? 0 : -1)));
  // A square with both diagonals, one of them too long. All joints exist twice, and hinges are added.
  for (int twice = 0; twice < 2; ++twice)
    for (const auto& [a, b] : {std::pair(0, 1), {1, 3}, {3, 2}, {2, 0}, {0, 3}, {1, 2}}) {
      scene.joints.push_back(joint_between(JointKind::distance, a, b));
      if (a == 0 && b == 3) scene.joints.back().length = 1.6;
    }
  scene.joints.push_back(joint_between(JointKind::hinge, 0, 1));
  scene.joints.push_back(joint_between(JointKind::ball, 0, 1));
  scene.joints.push_back(joint_to_world(JointKind::ball, 0, Vector3d(0, 0, 0)));
  scene.joints.push_back(joint_to_world(JointKind::hinge, 0, Vector3d(0, 0, 0)));
  World world(scene, options());
  world.step(1800);
  const StepStats stats = world.measure();
  EXPECT_EQ(stats.non_finite, 0);
  EXPECT_EQ(stats.joints, 16);
  EXPECT_LT(stats.max_joint_error, 0.15) << "all share what the diagonal is off";
  EXPECT_LT(stats.max_speed, 0.01) << "and hang still";
}

/// Joints that are metres apart, at bodies with a small moment of inertia. Warm starting with impulses for
/// the lever arms of the previous substep added energy in each substep.
TEST_P(JointedChains, ContradictionsStayBoundedHoweverLightlyBodiesTurn) {
  for (const double inertia : {1.0, 100.0, 650.0}) {
    Scene scene = joint_space(g, Precision::f64);
    scene.physics.substeps = 30;
    scene.physics.iterations = 2;
    scene.bodies = {sphere(2.6, Vector3d(0, 0, -4)), sphere(0.12, Vector3d(0, 0, 8))};
    scene.bodies[0].mass = 650'000;
    scene.bodies[0].inertia = inertia * Vector3d(1, 1.07, 1.06);
    scene.bodies[1].mass = 1.2;
    scene.joints = {joint_to_world(JointKind::ball, 0, Vector3d(-1.6, -1.8, -3.2)),
                    joint_to_world(JointKind::ball, 1, Vector3d(0.9, 1.7, 8.8)),
                    joint_between(JointKind::hinge, 1, 0)};
    scene.joints[0].anchor_a = Vector3d(0, -1, -0.3);
    scene.joints[1].anchor_a = Vector3d(-0.66, 0, 0);
    World world(scene, options());
    world.step(240);
    const StepStats stats = world.measure();
    EXPECT_EQ(stats.non_finite, 0) << inertia;
    EXPECT_LT(stats.max_speed, 1e5) << inertia;
  }
}

}  // namespace
}  // namespace collidoscope
