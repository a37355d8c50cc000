// Tests joints beside other features: contacts of joined bodies, bodies without dynamics, drawing, one answer
// in every order and shape, and the cost of absent joints.

#include <cmath>

#include "sim_cuda/run/published_records.h"
#include "tests/executors.h"
#include "tests/gravity.h"
#include "tests/joint_scenes.h"

namespace collidoscope {
namespace {

class JointedWorlds : public OnEachExecutor {};
ON_EACH_EXECUTOR(JointedWorlds);

TEST_P(JointedWorlds, BodiesHeldTogetherMayTouchOnlyIfTheySaySo) {
  for (const bool collide : {false, true}) {
    Scene scene = joint_space(0);
    scene.bodies = {sphere(0.5, Vector3d(0, 0, 0)), sphere(0.5, Vector3d(0.6, 0, 0)),
                    sphere(0.5, Vector3d(0.3, 0.4, 0))};
    scene.joints = {joint_between(JointKind::distance, 1, 0)};
    scene.joints[0].collide = collide;
    World world(scene, options());
    EXPECT_EQ(world.measure().touching, collide ? 3 : 2) << "the third touches both";
    EXPECT_EQ(world.measure().pairs, 3);
  }
}

TEST_P(JointedWorlds, BodiesThatNoForceMovesHoldTheOthers) {
  // A kinematic body pulls a pendulum along at constant speed. The motion in its frame equals that of the
  // fixed one.
  Scene scene = joint_space(g);
  scene.bodies = {sphere(0.1, Vector3d(0, 0, 0), Vector3d(3, 0, 0)),
                  sphere(0.3, Vector3d(1, 0, 0), Vector3d(3, 0, 0)), sphere(0.1, Vector3d(0, 5, 0)),
                  sphere(0.3, Vector3d(1, 5, 0))};
  scene.bodies[0].motion = Motion::kinematic;
  scene.bodies[2].motion = Motion::fixed;
  scene.joints = {
      joint_between(JointKind::distance, 0, 1), joint_between(JointKind::distance, 3, 2),
      joint_between(JointKind::ball, 0, 2)};  // a joint between two bodies without dynamics has no effect
  World world(scene, options());
  world.step(120);
  const BodyStates s = world.bodies();
  EXPECT_NEAR((s.position[0] - Vector3d(6, 0, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((s.position[2] - Vector3d(0, 5, 0)).norm(), 0, 0);
  EXPECT_NEAR(((s.position[1] - s.position[0]) - (s.position[3] - s.position[2])).norm(), 0, 1e-6);
  EXPECT_NEAR((s.position[3] - s.position[2]).norm(), 1, 1e-6);
}

TEST_P(JointedWorlds, AreDrawnWhereTheyAre) {
  Scene scene = joint_space(g);
  scene.bodies = {sphere(0.5, Vector3d(0, 0, 0)), sphere(0.25, Vector3d(3, 0, 0)),
                  sphere(1, Vector3d(0, 9, 0))};
  scene.bodies[1].orientation = Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5));  // x to y
  Joint rope = joint_between(JointKind::distance, 0, 1);
  rope.max_length = 5;
  rope.anchor_b = Vector3d(1, 0, 0);
  Joint hinge = joint_to_world(JointKind::hinge, 2, Vector3d(0, 8, 0));
  hinge.anchor_a = Vector3d(0, -1, 0);
  hinge.axis = Vector3d(1, 0, 0);
  scene.joints = {rope, joint_between(JointKind::spring, 2, 1), hinge};
  World world(scene, options());
  ASSERT_EQ(world.publisher().counts(0, -1).joints, 3);
  PublishedRecords records;
  world.publisher().copy(FrameLayers{}, records);
  const auto drawn = records.copy<JointInstance>();
  ASSERT_EQ(drawn.size(), 3u);
  // The spring is solved by iteration. Joints of trees follow.
  const auto at = [](const float(&v)[3]) { return Vector3d(v[0], v[1], v[2]); };
  EXPECT_EQ(drawn[1].look, static_cast<float>(JointLook::rope));
  EXPECT_NEAR((at(drawn[1].from) - Vector3d(0, 0, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((at(drawn[1].to) - Vector3d(3, 1, 0)).norm(), 0, 1e-6);
  EXPECT_EQ(drawn[1].size, 0.25f);
  const double length = std::sqrt(10.0), sag = std::sqrt((5 - length) * (5.0 / 4 + length / 8));
  EXPECT_NEAR((at(drawn[1].aside) - Vector3d(0, 0, -sag)).norm(), 0, 1e-5);
  EXPECT_EQ(drawn[2].look, static_cast<float>(JointLook::corner));
  EXPECT_NEAR((at(drawn[2].from) - Vector3d(0, 9, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((at(drawn[2].at) - Vector3d(0, 8, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((at(drawn[2].to) - Vector3d(0, 8, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((at(drawn[2].aside) - Vector3d(1, 0, 0)).norm(), 0, 1e-6);
  EXPECT_EQ(drawn[0].look, static_cast<float>(JointLook::spring));
}

Scene everything(Precision precision) {
  Scene scene = box_collider(300);
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = precision;
  scene.materials[0].friction = 0.3;
  const JointKind kinds[] = {JointKind::distance, JointKind::spring, JointKind::ball, JointKind::hinge};
  for (int k = 0; k < 200; ++k) {
    Joint joint = joint_between(kinds[k % 4], k, (k * 7 + 1) % 300);
    if (joint.a == *joint.b) joint.b = 299;
    joint.anchor_a = Vector3d(0.1 * (k % 3), 0.2, 0);
    if (k % 4 == 3) joint.limits = {-10, 20};
    if (k % 8 == 0) joint.max_length = 40;
    if (k % 11 == 0) joint.b.reset();
    if (!joint.b) joint.anchor_b = Vector3d(50, 50, 50);
    scene.joints.push_back(joint);
  }
  return scene;
}

TEST_P(JointedWorlds, OneAnswerInEveryOrderAndShape) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const Scene scene = everything(precision);
    const auto hash = [&](const RunOptions& o) {
      World world(scene, o);
      world.step(12);
      EXPECT_EQ(world.measure().non_finite, 0);
      return world.state_hash();
    };
    const std::uint64_t expected = hash(options());
    for (const LaunchShape shape : {LaunchShape{1, 1}, {2, 4}, {16, 16}, {264, 128}})
      for (const LaneOrder order : {LaneOrder::contiguous, LaneOrder::strided, LaneOrder::shuffled}) {
        if (GetParam() == ExecutorKind::cuda && order != LaneOrder::contiguous) continue;
        RunOptions o = options();
        o.shape = shape;
        o.lane_order = order;
        EXPECT_EQ(hash(o), expected) << shape.blocks << ' ' << static_cast<int>(order);
      }
    RunOptions tight = options();
    tight.initial_pair_capacity = 1;
    EXPECT_EQ(hash(tight), expected) << "an overflow leaves joints as they are";
    RunOptions cpu = options();
    cpu.executor = ExecutorKind::cpu;
    EXPECT_EQ(hash(cpu), expected);
  }
}

TEST_P(JointedWorlds, AnotherWorldGoesOnBitForBit) {
  const Scene scene = everything(Precision::f32);
  World whole(scene, options()), first(scene, options()), second(scene, options());
  whole.step(20);
  first.step(11);
  second.restore(first);
  second.step(9);
  EXPECT_EQ(second.state_hash(), whole.state_hash());

  // After a removal of the last bodies and their joints, the remaining joints keep their impulses.
  Scene fewer = scene;
  fewer.generators[0].count = 150;
  std::erase_if(fewer.joints,
                [](const Joint& joint) { return joint.a >= 150 || joint.b.value_or(0) >= 150; });
  ASSERT_GT(fewer.joints.size(), 50u);
  World rest(fewer, options());
  rest.restore(first);
  rest.step(5);
  EXPECT_EQ(rest.measure().non_finite, 0);
}

TEST_P(JointedWorlds, WithoutJointsNothingIsPaid) {
  Scene scene = box_collider(300);
  scene.physics.solver = Solver::soft_step;
  World never(scene, options());
  Scene listed = scene;
  listed.joints = {joint_between(JointKind::distance, 0, 1)};
  listed.joints[0].length = 1;
  listed.physics.effects = Effects{.gravity = true};
  World off(listed, options());
  never.step(4);
  off.step(4);
  EXPECT_EQ(off.info().allocated_bytes, never.info().allocated_bytes);
  EXPECT_EQ(off.state_hash(), never.state_hash());
  const auto launches = [](World& world) {
    int sum = 0;
    for (const StageTime& stage : world.times().stages) {
      EXPECT_NE(stage.name, "joints");
      sum += stage.launches;
    }
    return sum;
  };
  EXPECT_EQ(launches(off), launches(never));
  EXPECT_EQ(off.measure().joints, 0);
  listed.physics.effects.reset();
  World on(listed, options());
  on.step(4);
  EXPECT_NE(on.state_hash(), never.state_hash());
  EXPECT_GT(on.info().allocated_bytes, never.info().allocated_bytes);
}

}  // namespace
}  // namespace collidoscope
