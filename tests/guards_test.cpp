// Tests runs with an invalid step. The guards must report the same stage, substep and body on every executor.
// The run pauses at the state before, or freezes the body without an effect on the others.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Three spheres that settle on each other. Far from them, body 3 falls for ever and body 4 floats. Only body
/// 3 exceeds the speed limit of this scene.
Scene faller(Solver solver = Solver::soft_step, Precision precision = Precision::f32) {
  Scene scene;
  scene.name = "faller";
  scene.physics.solver = solver;
  scene.physics.precision = precision;
  scene.physics.guards = ValidationSettings{.speed = 5};
  scene.obstacles.push_back(Plane{});
  for (int k = 0; k < 3; ++k) scene.bodies.push_back(sphere(0.5, Vector3d(0.01 * k, 0, 0.6 + 1.05 * k)));
  scene.bodies.push_back(sphere(0.5, Vector3d(50, 0, 100)));
  Body& still = scene.bodies.emplace_back(sphere(0.25, Vector3d(50, 20, 100)));
  still.motion = Motion::kinematic;
  return scene;
}

Scene unguarded(Scene scene) {
  scene.physics.guards.reset();
  return scene;
}

Scene freezing(Scene scene) {
  scene.physics.guards->on_failure = OnFailure::freeze;
  return scene;
}

void expect_same_body(const BodyStates& a, const BodyStates& b, std::size_t id_a, std::size_t id_b) {
  EXPECT_EQ(a.position[id_a], b.position[id_b]) << id_a;
  EXPECT_EQ(a.velocity[id_a], b.velocity[id_b]) << id_a;
  EXPECT_EQ(a.angular_velocity[id_a], b.angular_velocity[id_b]) << id_a;
  EXPECT_EQ(a.orientation[id_a].coeffs(), b.orientation[id_b].coeffs()) << id_a;
}

class ValidatedRuns : public OnEachExecutor {
 protected:
  /// Calls `check` for each solver and precision.
  template <class Check>
  void in_each_way(const Check& check) {
    for (const auto& [name, solver, help] : solver_names)
      for (const auto& [width, precision, help] : precision_names) {
        SCOPED_TRACE(std::string(name) + ", " + std::string(width));
        check(faller(solver, precision));
      }
  }
};
ON_EACH_EXECUTOR(ValidatedRuns);

TEST_P(ValidatedRuns, PauseAtTheStateBeforeBitForBit) {
  in_each_way([&](Scene scene) {
    for (const Integrator integrator : {Integrator::velocity_verlet, Integrator::semi_implicit_euler}) {
      scene.physics.integrator = integrator;
      World world(scene, options()), other(unguarded(scene), options());
      world.step(40);
      // v = 5 m/s after 0.51 s: in the step to state 16.
      ASSERT_TRUE(world.validation().paused());
      EXPECT_EQ(world.steps(), 15);
      const Finding& finding = *world.validation().finding();
      const bool impulse = scene.physics.solver == Solver::impulse;
      EXPECT_EQ(finding.step, 16);
      EXPECT_EQ(finding.stage, !impulse                                    ? "forces"
                               : integrator == Integrator::velocity_verlet ? "integrate"
                                                                           : "move");
      EXPECT_EQ(finding.substep, impulse ? 1 : 2);
      EXPECT_EQ(finding.body, 3u);
      EXPECT_EQ(finding.quantity, FindingQuantity::velocity);
      EXPECT_NEAR(finding.value, impulse ? 16 * 9.81 / 30 : 62 * 9.81 / 120, 1e-4);
      EXPECT_FALSE(finding.invalid_before);
      other.step(15);
      EXPECT_EQ(world.state_hash(), other.state_hash());
      world.step(3);
      EXPECT_EQ(world.steps(), 15) << "it waits";

      // A run that continues without guards reaches the same state as a run that never had guards.
      world.validation().resume_without_guards();
      EXPECT_FALSE(world.validation().paused() || world.validation().finding());
      world.step(25);
      other.step(25);
      EXPECT_EQ(world.steps(), 40);
      EXPECT_EQ(world.state_hash(), other.state_hash());
    }
  });
}

TEST_P(ValidatedRuns, FreezeTheBodyAndLeaveTheOthersAlone) {
  in_each_way([&](const Scene& scene) {
    World world(freezing(scene), options()), other(unguarded(scene), options());
    other.step(15);
    const BodyStates before = other.bodies();
    world.step(40);
    other.step(25);
    EXPECT_EQ(world.steps(), 40);
    EXPECT_FALSE(world.validation().paused());
    EXPECT_THAT(world.validation().frozen(), ElementsAre(3u));
    EXPECT_EQ(world.validation().finding()->step, 16);
    const BodyStates now = world.bodies(), well = other.bodies();
    for (const std::size_t body : {0, 1, 2, 4}) expect_same_body(now, well, body, body);
    EXPECT_EQ(now.position[3], before.position[3]);
    EXPECT_EQ(now.velocity[3], Vector3d(0, 0, 0));
  });
}

/// The ball has impulses of the ground, and friction, when it is frozen.
TEST_P(ValidatedRuns, FreezeABallThatRollsOnTheGround) {
  for (const Solver solver : {Solver::soft_step, Solver::jacobi_split}) {
    Scene scene = freezing(faller(solver));
    scene.physics.gravity = Vector3d(6, 0, -9.81);
    scene.materials[0].friction = 0.5;
    scene.bodies = {sphere(0.5, Vector3d(0, 0, 0.5))};
    World world(scene, options());
    world.step(120);  // it has 5 m/s after 1.2 s
    EXPECT_EQ(world.steps(), 120);
    EXPECT_FALSE(world.validation().paused());
    ASSERT_THAT(world.validation().frozen(), ElementsAre(0u));
    EXPECT_EQ(world.bodies().velocity[0], Vector3d(0, 0, 0));
    EXPECT_NEAR(world.bodies().position[0].x(), 25.0 * 7 / (2 * 5 * 6.0), 0.2);  // v^2 / (2 a)
  }
}

TEST_P(ValidatedRuns, FindTheSameInWhateverWayTheyRun) {
  Scene scene = box_collider(300);
  scene.physics.solver = Solver::soft_step;
  scene.generators[0].spawn = Spawn::apart;
  scene.generators[0].speed_max = 15;
  scene.physics.guards = ValidationSettings{.speed = 45};
  std::optional<Finding> first;
  std::uint64_t hash = 0;
  for (int way = 0; way < 5; ++way) {
    RunOptions o = options();
    if (way == 1) o.shape = {3, 32};
    if (way == 2) o.lane_order = LaneOrder::shuffled;
    if (way == 3) o.broad_phase = "brute_force";
    if (way == 4) o.initial_pair_capacity = 1;
    World world(scene, o);
    world.step(100);
    ASSERT_TRUE(world.validation().paused()) << way;
    if (!first) {
      first = world.validation().finding();
      hash = world.state_hash();
      EXPECT_GT(world.steps(), 3) << "of steps that were well";
    }
    EXPECT_EQ(describe(*world.validation().finding()), describe(*first)) << way;
    EXPECT_EQ(world.validation().finding()->value, first->value) << way;
    EXPECT_EQ(world.state_hash(), hash) << way;
  }
}

TEST_P(ValidatedRuns, FindWhatWasBadBeforeTheStep) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  in_each_way([&](const Scene& scene) {
    World well(unguarded(scene), options());
    well.step(7);
    RunState state = well.state();
    well.step(5);
    const BodyStates others = well.bodies();
    for (const bool moving : {false, true}) {
      RunState injected = state;
      (moving ? injected.bodies.velocity : injected.bodies.position)[3].x() = nan;
      World world(scene, options());
      world.restore(injected);
      world.step(5);
      ASSERT_TRUE(world.validation().paused());
      EXPECT_EQ(world.steps(), 7);
      const bool in_box = !moving || scene.physics.solver != Solver::impulse;
      EXPECT_EQ(world.validation().finding()->stage, in_box ? "bounds" : "prescribe");
      EXPECT_EQ(world.validation().finding()->step, 8);
      EXPECT_EQ(world.validation().finding()->body, 3u);
      EXPECT_TRUE(world.validation().finding()->invalid_before);
      EXPECT_TRUE(std::isnan(world.validation().finding()->value));

      World frozen(freezing(scene), options());
      frozen.restore(injected);
      frozen.step(5);
      EXPECT_THAT(frozen.validation().frozen(), ElementsAre(3u));
      EXPECT_EQ(frozen.steps(), 12);
      const BodyStates now = frozen.bodies();
      for (const std::size_t body : {0, 1, 2, 4}) expect_same_body(now, others, body, body);
      // A body at an invalid position is placed at its start position.
      EXPECT_EQ(now.position[3], moving ? state.bodies.position[3] : scene.bodies[3].position);
    }
  });
}

TEST_P(ValidatedRuns, PauseWhereFreezingIsOfNoUse) {
  Scene scene = freezing(faller());
  scene.bodies[4].velocity = Vector3d(0, 6, 0);  // a prescribed velocity above the limit of the guards
  World world(scene, options());
  world.step(3);
  EXPECT_TRUE(world.validation().paused());
  EXPECT_EQ(world.validation().finding()->body, 4u);
  EXPECT_THAT(world.validation().frozen(), ElementsAre());
}

TEST_P(ValidatedRuns, StayFrozenThroughChangesSnapshotsAndNewIds) {
  World world(freezing(faller()), options());
  world.step(20);
  ASSERT_THAT(world.validation().frozen(), ElementsAre(3u));
  const Vector3d place = world.bodies().position[3];

  World loaded = world_from(snapshot_of(world), world.scene(), options());
  EXPECT_THAT(loaded.validation().frozen(), ElementsAre(3u));
  Change change;
  change.step = 20;
  change.remove = {1};
  const auto changed = world_after_change(world, change, world.options());
  EXPECT_THAT(changed->validation().frozen(), ElementsAre(2u));
  Change nobody_looks;
  nobody_looks.step = 20;
  Effects without = world.effects();
  without.guards = false;
  nobody_looks.settings.set<&Physics::effects>(std::optional(without));
  const auto unwatched = world_after_change(world, nobody_looks, world.options());

  world.step(10);
  loaded.step(10);
  changed->step(10);
  unwatched->step(10);
  EXPECT_EQ(loaded.state_hash(), world.state_hash());
  EXPECT_EQ(unwatched->state_hash(), world.state_hash());
  EXPECT_EQ(changed->bodies().position[2], place);
  World again(world.scene(), options());
  EXPECT_THAT(again.validation().frozen(), ElementsAre());
}

TEST_P(ValidatedRuns, CountSubstepsThatAreRunsOfTheirOwn) {
  Scene scene = faller(Solver::impulse);
  scene.physics.substeps = 4;
  World world(scene, options()), other(unguarded(scene), options());
  world.step(30);
  other.step(15);
  ASSERT_TRUE(world.validation().paused());
  EXPECT_EQ(world.validation().finding()->step, 16);
  EXPECT_EQ(world.validation().finding()->substep, 2);
  EXPECT_EQ(world.state_hash(), other.state_hash());
}

TEST_P(ValidatedRuns, FindBoxesThatWouldOverflowEveryList) {
  Scene scene = box_collider(400);
  scene.physics.solver = Solver::soft_step;
  scene.physics.guards = ValidationSettings{};
  World world(scene, options());
  world.step(2);
  RunState state = world.state();
  const std::uint64_t hash = world.state_hash();
  for (Vector3d& v : state.bodies.velocity) v = Vector3d(0x1p40, 0x1p40, 0x1p40);  // all boxes overlap
  world.restore(state);
  world.step();
  ASSERT_TRUE(world.validation().paused());
  EXPECT_EQ(world.validation().finding()->stage, "bounds");
  EXPECT_TRUE(world.validation().finding()->invalid_before);
  EXPECT_NE(world.state_hash(), hash);
  EXPECT_EQ(world.bodies().velocity, state.bodies.velocity);
}

struct Footprint {
  std::map<std::string, int> launches;
  std::map<std::string, std::int64_t> buffers;
  std::uint64_t hash = 0;

  Footprint(const Scene& scene, const RunOptions& options) {
    World world(scene, options);
    world.step(6);
    for (const StageTime& stage : world.times().stages) launches[stage.name] = stage.launches;
    buffers = world.buffers();
    hash = world.state_hash();
  }
};

TEST_P(ValidatedRuns, CostNothingOffAndALaunchForEachLookOn) {
  in_each_way([&](Scene scene) {
    scene.physics.guards->speed = 100;
    Scene off = scene;
    off.physics.effects = required_effects(scene, initial_bodies(scene));
    off.physics.effects->guards = false;
    const Footprint never(unguarded(scene), options()), left_out(off, options()), on(scene, options());
    EXPECT_EQ(left_out.launches, never.launches);
    EXPECT_EQ(left_out.buffers, never.buffers);
    EXPECT_EQ(left_out.hash, never.hash);
    EXPECT_EQ(on.hash, never.hash) << "who looks changes nothing";
    std::map<std::string, int> rest = on.launches;
    EXPECT_GT(rest["guard"], 5);
    rest.erase("guard");
    EXPECT_EQ(rest, never.launches);
  });
}

TEST(Guards, AreNoSettingThatWakesWhatSleeps) {
  Scene scene = unguarded(faller());
  scene.physics.sleep = Sleep{};
  RunOptions cpu;
  cpu.executor = ExecutorKind::cpu;
  World world(scene, cpu);
  world.step(60);
  const std::uint64_t settings = world.state().settings;
  EXPECT_NE(settings, 0u);
  scene.physics.guards = ValidationSettings{};
  EXPECT_EQ(World(scene, cpu).state().settings, settings);
}

TEST(Finding, NamesAllThatItKnows) {
  Finding finding{8, 2, "forces", 3, FindingQuantity::velocity, 3.2e10, false};
  EXPECT_EQ(describe(finding), "stage forces of step 8, substep 2: body 3 has the velocity 3.2e+10 m/s");
  finding.quantity = FindingQuantity::orientation;
  finding.value = std::numeric_limits<double>::quiet_NaN();
  finding.invalid_before = true;
  EXPECT_EQ(
      describe(finding),
      "stage forces of step 8, substep 2: body 3 has the orientation nan; it was already invalid in state 7");
}

}  // namespace
}  // namespace collidoscope
