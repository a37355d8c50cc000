// Tests joint trees: which joints form trees, and known answers with default settings: pendulums, limits, and
// conservation by free trees.

#include <cmath>

#include "sim_cuda/scene/joint_trees.h"
#include "tests/energy_scenes.h"
#include "tests/executors.h"

namespace collidoscope {
namespace {

// ---- the trees of a scene ----

/// Bodies in a row, 1 m apart.
Scene row_of_balls(int count) {
  Scene scene = impact_space(0, g);
  for (int k = 0; k < count; ++k) scene.bodies.push_back(ball(1, 0.1, Vector3d(k + 1, 0, 0)));
  return scene;
}

void join(Scene& scene, JointKind kind, std::int64_t a, std::optional<std::int64_t> b) {
  scene.joints.push_back(joint_at(scene, kind, a, b, Vector3d(static_cast<double>(a), 0, 0)));
}

JointTrees trees_of(const Scene& scene) {
  const InitialBodies bodies = initial_bodies(scene);
  const std::vector<PlacedJoint> joints = place_joints(scene, bodies);
  JointTrees trees = find_joint_trees(joints, bodies_that_respond(bodies));
  find_spin_axes(
      trees, joints,
      bodies.inertia.empty() ? std::vector<Vector3d>(bodies.size(), Vector3d(1, 1, 1)) : bodies.inertia);
  return trees;
}

TEST(JointTrees, HaveBodiesBeforeTheirParents) {
  Scene scene = row_of_balls(6);
  join(scene, JointKind::ball, 2, 1);
  join(scene, JointKind::ball, 1, 0);
  join(scene, JointKind::hinge, 3, 1);
  join(scene, JointKind::distance, 1, std::nullopt);
  join(scene, JointKind::ball, 5, 4);
  const JointTrees trees = trees_of(scene);
  ASSERT_EQ(trees.count(), 2u);
  EXPECT_EQ(trees.begin, (std::vector<std::uint32_t>{0, 4, 6}));
  for (std::size_t tree = 0; tree < trees.count(); ++tree)
    for (std::uint32_t node = trees.begin[tree]; node < trees.begin[tree + 1]; ++node) {
      const bool is_root = node + 1 == trees.begin[tree + 1];
      EXPECT_EQ(trees.nodes[node].parent == TreeNode::none, is_root);
      if (!is_root) {
        EXPECT_GT(trees.nodes[node].parent, node);
      }
    }
  EXPECT_EQ(trees.nodes[3].body, 1u) << "the root is the body at the world";
  EXPECT_EQ(trees.nodes[3].joint, 3u);
  EXPECT_EQ(trees.nodes[5].joint, TreeNode::none) << "a free tree";
}

TEST(JointTrees, HaveClosingJointsInLoops) {
  const auto closings = [](const Scene& scene) {
    const JointTrees trees = trees_of(scene);
    EXPECT_EQ(trees.count(), 1u);
    for (const bool in_tree : trees.in_tree) EXPECT_TRUE(in_tree);
    for (const TreeClosing& closing : trees.closings) {
      const PlacedJoint joint = place_joints(scene, initial_bodies(scene))[closing.joint];
      EXPECT_EQ(trees.nodes.at(closing.node_a).body, joint.a);
      if (joint.b != PlacedJoint::world)
        EXPECT_EQ(trees.nodes.at(closing.node_b).body, joint.b);
      else
        EXPECT_EQ(closing.node_b, TreeNode::none);
    }
    return trees.closings.size();
  };
  Scene scene = row_of_balls(3);
  join(scene, JointKind::ball, 1, 0);
  join(scene, JointKind::ball, 2, 1);
  EXPECT_EQ(closings(scene), 0u);
  Scene ring = scene;
  join(ring, JointKind::distance, 2, 0);
  EXPECT_EQ(closings(ring), 1u);
  Scene twice = scene;
  join(twice, JointKind::hinge, 1, 0);
  EXPECT_EQ(closings(twice), 1u);
  Scene bridge = scene;
  join(bridge, JointKind::ball, 0, std::nullopt);
  EXPECT_EQ(closings(bridge), 0u);
  join(bridge, JointKind::ball, 2, std::nullopt);
  join(bridge, JointKind::ball, 2, std::nullopt);
  EXPECT_EQ(closings(bridge), 2u) << "three joints to the world";
}

/// A group with too many closing equations is iterated; springs connect nothing.
TEST(JointTrees, AreOfLimitedSize) {
  Scene scene = row_of_balls(3);
  join(scene, JointKind::ball, 1, 0);
  join(scene, JointKind::spring, 2, 0);
  JointTrees trees = trees_of(scene);
  EXPECT_EQ(trees.count(), 1u);
  EXPECT_EQ(trees.in_tree, (std::vector<bool>{true, false}));
  for (int k = 0; k < JointTrees::max_closing_rows / 3; ++k) join(scene, JointKind::ball, 1, 0);
  EXPECT_EQ(trees_of(scene).closings.size(), 6u);
  join(scene, JointKind::distance, 1, 0);
  trees = trees_of(scene);
  EXPECT_EQ(trees.count(), 0u);
  EXPECT_EQ(trees.closings.size(), 0u);
  const InitialBodies bodies = initial_bodies(scene);
  const JointLoopGroups loops =
      find_joint_loops(place_joints(scene, bodies), trees.in_tree, bodies_that_respond(bodies));
  EXPECT_EQ(loops.bodies, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(loops.begin, (std::vector<std::uint32_t>{0, 2}));
  EXPECT_TRUE(loops.supports.empty());
}

TEST(JointTrees, EndAtKinematicBodies) {
  Scene scene = row_of_balls(3);
  join(scene, JointKind::ball, 1, 0);
  join(scene, JointKind::ball, 2, 1);
  scene.bodies[1].motion = Motion::kinematic;
  EXPECT_EQ(trees_of(scene).count(), 2u);
}

TEST(JointTrees, SpinFreelyAboutAxesOfSymmetry) {
  Scene scene = row_of_balls(1);
  scene.bodies[0].inertia = Vector3d(1, 1, 2);
  scene.joints = {joint_at(scene, JointKind::ball, 0, std::nullopt, Vector3d(1, 0, -1))};
  const auto axis = [&] {
    const JointTrees trees = trees_of(scene);
    return trees.nodes.at(0).spin_axis;
  };
  EXPECT_EQ(std::abs(axis().z()), 1);
  scene.bodies[0].inertia = Vector3d(1, 1.5, 2);
  EXPECT_EQ(axis().norm(), 0) << "not symmetric";
  scene.bodies[0].inertia = Vector3d(1, 1, 2);
  scene.joints[0].anchor_a = Vector3d(0.5, 0, -1);
  EXPECT_EQ(axis().norm(), 0) << "the anchor would turn";
  scene.bodies[0].inertia = Vector3d(2, 2, 2);
  EXPECT_NEAR(axis().norm(), 1, 1e-12) << "any axis of a sphere";
  scene.joints[0].kind = JointKind::hinge;
  EXPECT_EQ(axis().norm(), 0) << "a hinge across";
}

// ---- known answers ----

class JointTreeRuns : public OnEachExecutor {};
ON_EACH_EXECUTOR(JointTreeRuns);

/// Two links of 1 m, released horizontally.
Scene double_pendulum(JointKind kind, int rate) {
  Scene scene = row_of_balls(2);
  scene.physics.precision = Precision::f64;
  scene.physics.time_step = TimeStep::per_second(rate);
  scene.joints = {joint_at(scene, kind, 0, std::nullopt, Vector3d(0, 0, 0)),
                  joint_at(scene, kind, 1, 0, Vector3d(1, 0, 0))};
  return scene;
}

/// Largest change of the energy in 20 s, relative to 3mgL.
double energy_change(const Scene& scene, const RunOptions& options) {
  World world(scene, options);
  const double start = world.measure().energy();
  double largest = 0;
  for (int k = 0; k < static_cast<int>(20 / scene.physics.time_step); ++k) {
    world.step();
    largest = std::max(largest, std::abs(world.measure().energy() - start));
  }
  return largest / (3 * g);
}

TEST_P(JointTreeRuns, ADoublePendulumKeepsItsEnergy) {
  for (const JointKind kind : {JointKind::distance, JointKind::hinge}) {
    double before = 5e-3;
    for (const int rate : {30, 60, 120}) {
      const double change = energy_change(double_pendulum(kind, rate), options());
      EXPECT_LT(change, before) << rate;
      before = change / 3;
    }
  }
}

/// A ball on an arm falls from the horizontal until its hinge has turned by 30 degrees.
TEST_P(JointTreeRuns, LimitsStopAFall) {
  for (const double arm : {0.3, 1.0, 5.0})
    for (const int rate : {30, 60, 240, 1000})
      for (const Precision precision : {Precision::f32, Precision::f64}) {
        Scene scene = impact_space(0, g);
        scene.physics.precision = precision;
        scene.physics.time_step = TimeStep::per_second(rate);
        scene.bodies = {ball(1, 0.1, Vector3d(arm, 0, 0))};
        scene.joints = {joint_at(scene, JointKind::hinge, 0, std::nullopt, Vector3d(0, 0, 0))};
        scene.joints[0].limits = {-30, 30};
        World world(scene, options());
        const double fall = g * arm / 2, start = world.measure().energy();
        double lowest = start, rise = 0, deepest = 0;
        for (int k = 0; k < 3 * rate; ++k) {
          world.step();
          const StepStats now = world.measure();
          rise = std::max(rise, now.energy() - lowest);
          lowest = std::min(lowest, now.energy());
          deepest = std::max(deepest, now.max_joint_angle);
        }
        EXPECT_LT(rise, 5e-3 * fall) << arm << ' ' << rate;
        EXPECT_LT(deepest, precision == Precision::f64 ? 1e-6 : 1e-4) << arm << ' ' << rate;
        EXPECT_NEAR(world.bodies().position[0].z(), -arm / 2, 1e-4 * arm) << rate;
        EXPECT_LT(world.measure().max_speed, 1e-3) << arm << ' ' << rate;
      }
}

/// Any tree without forces: momentum, angular momentum and energy.
TEST_P(JointTreeRuns, FreeTreesConserve) {
  for (int seed = 0; seed < 10; ++seed) {
    Uniform uniform{Random(static_cast<std::uint32_t>(seed))};
    Scene scene =
        any_tree(uniform, one_of(uniform, {JointKind::distance, JointKind::ball, JointKind::hinge}), 10);
    scene.physics.precision = Precision::f64;
    scene.physics.gravity.setZero();
    scene.physics.effects = Effects{.rotation = true, .joints = true};
    std::erase_if(scene.joints, [](const Joint& joint) { return !joint.b; });
    for (Body& body : scene.bodies) {
      if (!body.inertia) body.inertia = Vector3d::Constant(0.004 * *body.mass);
      body.radius = 1e-3;  // no contacts
    }
    World world(scene, options());
    world.step();  // removes velocities that the joints do not allow
    const auto angular_momentum = [&] {
      const BodyStates s = world.bodies();
      Vector3d sum(0, 0, 0);
      for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Quaterniond q = s.orientation[i].normalized();
        sum += *scene.bodies[i].mass * s.position[i].cross(s.velocity[i]) +
               q * scene.bodies[i].inertia->cwiseProduct(q.conjugate() * s.angular_velocity[i]);
      }
      return sum;
    };
    const StepStats start = world.measure();
    const Vector3d turning = angular_momentum();
    double rise = 0;
    for (int k = 0; k < 300; ++k) {
      world.step();
      rise = std::max(rise, world.measure().energy() / start.energy() - 1);
    }
    EXPECT_LT(rise, 1e-5) << write_scene(scene);
    double momentum = 0;
    for (int k = 0; k < 3; ++k)
      momentum = std::max(momentum, std::abs(world.measure().momentum[k] - start.momentum[k]));
    EXPECT_LT(momentum, 1e-9) << seed;
    EXPECT_LT((angular_momentum() - turning).norm(), 1e-7 * turning.norm()) << write_scene(scene);
  }
}

}  // namespace
}  // namespace collidoscope
