// Tests sleeping: islands fall asleep at rest, cost nothing while asleep, and wake at a possible contact.

#include "sim_cuda/solver/sleeping.h"
#include "sim_cuda/run/published_records.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/names.h"
#include "tests/executors.h"
#include "tests/sleeping_scenes.h"

namespace collidoscope {
namespace {

class Sleepers : public OnEachExecutor {};
ON_EACH_EXECUTOR(Sleepers);

TEST_P(Sleepers, FallAsleepTogetherOnceAllHaveBeenSlowForTheTime) {
  Scene scene = sleeping_columns({0, 10}, 3);
  scene.bodies[5].position.z() = 5.8;  // falls for 0.4 s onto the second column
  World world(scene, options());
  int first = 0, second = 0;
  for (int step = 1; step <= 120; ++step) {
    world.step();
    const int left = count_asleep(world, 0, 3), right = count_asleep(world, 3);
    EXPECT_TRUE(left == 0 || left == 3) << step;
    // Before its impact, the falling sphere is an island of its own.
    EXPECT_TRUE(right == 0 || right == 3 || (step < 40 && right == 2)) << step;
    if (left == 3 && first == 0) first = step;
    if (right == 3 && second == 0) second = step;
  }
  EXPECT_EQ(first, 17) << "slow from the second step on";
  EXPECT_GT(second, 15 + 12);
  EXPECT_LT(second, 60);
  EXPECT_EQ(world.measure().kinetic_energy, 0);
}

TEST_P(Sleepers, KeepTheirStateAndWhatIsRememberedOfThem) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Scene scene = sleeping_columns({0, 2, 30}, 3);
    scene.materials[0].rolling_resistance = 0.01;
    scene.physics.precision = precision;
    World world(scene, options());
    world.step(150);
    ASSERT_EQ(count_asleep(world), 9) << name_of(precision_names, precision);
    world.step(2);  // contacts without impulse lose their cache entry with the velocity
    const RunState before = world.state();
    const std::uint64_t hash = world.state_hash();
    world.step(100);
    EXPECT_EQ(world.state_hash(), hash);
    const RunState after = world.state();
    ASSERT_EQ(after.warm_start.contacts.size(), before.warm_start.contacts.size());
    EXPECT_GE(after.warm_start.contacts.size(), 6u);
    for (std::size_t k = 0; k < after.warm_start.contacts.size(); ++k)
      EXPECT_EQ(after.warm_start.contacts[k].impulse, before.warm_start.contacts[k].impulse);
    EXPECT_EQ(after.warm_start.friction, before.warm_start.friction);
    EXPECT_EQ(after.warm_start.rolling, before.warm_start.rolling);
    EXPECT_EQ(after.warm_start.walls, before.warm_start.walls);
    EXPECT_EQ(after.warm_start.wall_friction, before.warm_start.wall_friction);
    EXPECT_EQ(after.warm_start.wall_rolling, before.warm_start.wall_rolling);
  }
}

TEST_P(Sleepers, WakeWhereTheyAreTouchedAndOnlyThere) {
  Scene scene = sleeping_columns({0, 10, 20}, 4);
  scene.bodies.push_back(sphere(0.5, Vector3d(10, 0, 60)));  // falls for 3.2 s onto the middle column
  World world(scene, options());
  world.step(80);
  ASSERT_EQ(count_asleep(world), 12);
  const BodyStates before = world.bodies();
  bool woken = false;
  for (int step = 0; step < 60; ++step) {
    world.step();
    woken = woken || count_asleep(world, 4, 8) == 0;
    EXPECT_EQ(count_asleep(world, 0, 4), 4);
    EXPECT_EQ(count_asleep(world, 8, 12), 4);
  }
  EXPECT_TRUE(woken);
  const BodyStates after = world.bodies();
  for (const std::size_t i : {0, 1, 2, 3, 8, 9, 10, 11})
    EXPECT_EQ(after.position[i], before.position[i]) << i;
  EXPECT_NE(after.position[7], before.position[7]);
}

TEST_P(Sleepers, TouchedInTheVeryStepInWhichTheyWouldFallAsleep) {
  // The row falls asleep in its 16th step. A fast ball arrives in one of the steps from 13 to 18. It must
  // never hit a body that acts like a fixed one.
  for (int k = 13; k <= 18; ++k) {
    Scene scene = sleeping_columns({0}, 1);
    scene.physics.gravity = Vector3d(0, 0, 0);
    scene.obstacles.clear();
    scene.materials[0].friction = 0;
    scene.materials[0].restitution = 1;
    const double speed = 30;
    scene.bodies.push_back(sphere(1, Vector3d(-2 - speed * (k - 0.5) / 30, 0, 1), Vector3d(speed, 0, 0)));
    World world(scene, options());
    world.step(25);
    const BodyStates states = world.bodies();
    EXPECT_NEAR(states.velocity[0].x(), speed, 1e-3) << k;
    EXPECT_NEAR(states.velocity[1].x(), 0, 1e-3) << k;
    EXPECT_EQ(count_asleep(world), 0) << k;
  }
}

TEST_P(Sleepers, WakeWhenASettingOrABodyTheyRestOnChanges) {
  const Scene scene = sleeping_columns({0, 10}, 2);
  World world(scene, options());
  world.step(60);
  ASSERT_EQ(count_asleep(world), 4);
  World same(scene, options());
  same.restore(world);
  same.step();
  EXPECT_EQ(count_asleep(same), 4);
  Scene turned = scene;
  turned.physics.gravity = Vector3d(0, 0, 3);
  World other(turned, options());
  other.restore(world);
  other.step();
  EXPECT_EQ(count_asleep(other), 0);

  // The lower sphere of the last column is removed; body 2 rests on body 3.
  Scene upside_down = sleeping_columns({0}, 2);
  upside_down.bodies.push_back(sphere(1, Vector3d(10, 0, 3)));
  upside_down.bodies.push_back(sphere(1, Vector3d(10, 0, 1)));
  World full(upside_down, options());
  full.step(60);
  ASSERT_EQ(count_asleep(full), 4);
  RunState state = full.state();
  upside_down.bodies.pop_back();
  World less(upside_down, options());
  state.settings = less.state().settings;  // as after a change of a generator's N
  less.restore(state);
  less.step();
  EXPECT_EQ(count_asleep(less), 2);
  EXPECT_FALSE(bodies_asleep(less)[2]);
}

TEST_P(Sleepers, ABodyThatSpinsOrRollsIsNotAtRest) {
  Scene scene = sleeping_columns({0, 10}, 1);
  scene.bodies[0].angular_velocity = Vector3d(0, 0, 1);  // drills: friction at a point does not stop it
  World world(scene, options());
  world.step(60);
  EXPECT_FALSE(bodies_asleep(world)[0]);
  EXPECT_TRUE(bodies_asleep(world)[1]);
}

TEST_P(Sleepers, ThatAJointHoldsSleepAndWakeWithWhatItHolds) {
  // A rod of 10 m between two balls. The second ball is hit.
  Scene scene = sleeping_columns({0, 10}, 1);
  scene.joints.emplace_back();
  scene.joints[0].a = 0;
  scene.joints[0].b = 1;
  scene.bodies.push_back(sphere(1, Vector3d(34, 0, 1), Vector3d(-6, 0, 0)));
  scene.bodies.back().angular_velocity = Vector3d(0, -6, 0);
  World joined(scene, options());
  joined.step(40);
  EXPECT_EQ(count_asleep(joined, 0, 2), 2);
  const std::uint64_t impulses = joined.state().warm_start.joints.size();
  EXPECT_EQ(impulses, 1u);
  joined.step(90);  // it hits body 1 at state 110; body 0 is 10 m away
  EXPECT_EQ(count_asleep(joined), 0);
  EXPECT_LT(joined.bodies().velocity[0].x(), -0.5);
  scene.joints.clear();
  World apart(scene, options());
  apart.step(120);
  EXPECT_TRUE(bodies_asleep(apart)[0]);
  EXPECT_FALSE(bodies_asleep(apart)[1]);
}

TEST_P(Sleepers, OnWhatNoForceMovesAreOnesOwnAndWakeWhenItMoves) {
  // Two balls, one on a static sphere and one on a slow kinematic sphere.
  Scene scene = sleeping_columns({}, 1);
  scene.obstacles.clear();
  for (const double x : {0.0, 40.0}) {
    scene.bodies.push_back(sphere(10, Vector3d(x, 0, -10)));
    scene.bodies.back().motion = x == 0 ? Motion::fixed : Motion::kinematic;
    scene.bodies.push_back(sphere(1, Vector3d(x, 0, 1)));
  }
  scene.bodies[2].velocity = Vector3d(0, 0, 0.01);  // below the sleep speed, but it keeps moving
  World world(scene, options());
  world.step(90);
  const std::vector<bool> asleep = bodies_asleep(world);
  EXPECT_FALSE(asleep[0]);
  EXPECT_TRUE(asleep[1]) << "what is fixed joins nothing";
  EXPECT_FALSE(asleep[2]);
  EXPECT_FALSE(asleep[3]);
  EXPECT_NEAR(world.bodies().position[2].z(), -10 + 0.03, 1e-3);
}

TEST_P(Sleepers, GiveTheSameBitsAtEveryLaunchShape) {
  Scene scene = box_collider(400);
  scene.generators[0].radius_max = 7;
  scene.physics.solver = Solver::soft_step;
  scene.physics.sleep = Sleep{.speed = 1, .time = 0.1};  // bodies fall asleep and wake all the time
  scene.materials[0].friction = 0.6;
  World first(scene, options());
  first.step(150);
  const std::uint64_t expected = first.state_hash();
  EXPECT_GT(count_asleep(first), 20);
  EXPECT_LT(count_asleep(first), 400);
  for (const LaunchShape shape : {LaunchShape{1, 1}, {2, 4}, {16, 16}, {3, 37}})
    for (const LaneOrder order : {LaneOrder::contiguous, LaneOrder::strided, LaneOrder::shuffled}) {
      if (GetParam() == ExecutorKind::cuda && order != LaneOrder::contiguous) continue;
      RunOptions o = options();
      o.shape = shape;
      o.lane_order = order;
      o.cpu_threads = 2;
      o.initial_pair_capacity = 50;  // a repeated step counts sleep only once
      World world(scene, o);
      world.step(70);
      World second(scene, o);
      second.restore(world);
      second.step(80);
      EXPECT_EQ(second.state_hash(), expected) << shape.blocks << " x " << shape.threads;
    }
}

TEST_P(Sleepers, AreCountedAndDrawn) {
  Scene scene = sleeping_columns({0, 10, 20}, 2);
  scene.bodies[5].position.z() = 40;  // falling
  World world(scene, options());
  EXPECT_TRUE(world.measure().can_sleep);
  EXPECT_EQ(world.measure().islands, 0) << "before the first step";
  world.step(8);
  const auto values = [&] {
    FrameLayers layers;
    layers.spheres = true;
    layers.color = BodyColor::sleep;
    PublishedRecords records;
    world.publisher().copy(layers, records);
    std::vector<float> value;
    for (const BodyInstance& body : records.copy<BodyInstance>()) value.push_back(body.value);
    return value;
  };
  EXPECT_THAT(values(), testing::ElementsAre(0.6f, 0.6f, 0.6f, 0.6f, 0.6f, 1)) << "8 of 15 steps at rest";
  world.step(22);
  const StepStats stats = world.measure();
  EXPECT_EQ(stats.asleep, 5);
  EXPECT_EQ(stats.islands, 4);
  EXPECT_EQ(stats.islands_asleep, 3);
  EXPECT_THAT(values(), testing::ElementsAre(0, 0, 0, 0, 0, 1));

  World loaded(scene, options());
  loaded.restore(world);
  EXPECT_EQ(loaded.measure().asleep, 5);
  EXPECT_EQ(loaded.measure().islands, 0) << "before its first step";
  scene.physics.sleep.reset();
  World never(scene, options());
  never.step();
  EXPECT_FALSE(never.measure().can_sleep);
}

TEST_P(Sleepers, OffTheyCostNothing) {
  Scene off = sleeping_columns({0, 2}, 3), on = off;
  off.physics.sleep.reset();
  Scene listed = on;
  listed.physics.effects = Effects{.gravity = true, .rotation = true, .friction = true};
  World without(off, options()), unlisted(listed, options()), with(on, options());
  for (World* world : {&without, &unlisted, &with}) world->step(6);
  EXPECT_EQ(without.info().allocated_bytes, unlisted.info().allocated_bytes);
  EXPECT_LT(without.info().allocated_bytes, with.info().allocated_bytes);
  EXPECT_EQ(without.state_hash(), unlisted.state_hash());
  EXPECT_EQ(without.state_hash(), with.state_hash()) << "until something sleeps";
  EXPECT_TRUE(without.state().warm_start.sleep_timer.empty());
  const auto launches = [](World& world) {
    int all = 0;
    for (const StageTime& stage : world.times().stages) all += static_cast<int>(stage.launches);
    return all;
  };
  EXPECT_EQ(launches(without), launches(unlisted));
  EXPECT_EQ(launches(without) + 6, launches(with))
      << "four for the islands, one to count, one for the colours";
}

TEST_P(Sleepers, APileOfThousandsSleepsWholeAndWakesWhereItIsTouched) {
  Scene scene = box_collider(5000);
  scene.box = Box{{0, 0, 0}, {13, 13, 13}};  // 30 % full
  scene.generators[0].radius_max = 0.5;
  scene.physics.solver = Solver::soft_step;
  scene.physics.sleep = Sleep{};
  scene.materials[0].friction = 0.5;
  scene.materials[0].rolling_resistance = 0.1;  // without it, bodies roll in bowls for ever
  scene.materials[0].restitution = 0.2;
  World world(scene, options());
  while (count_asleep(world) < 5000 && world.steps() < 400) world.step(25);
  ASSERT_EQ(count_asleep(world), 5000) << "12 s after they were dropped";
  const std::uint64_t hash = world.state_hash();
  const StepStats rest = world.measure();
  EXPECT_EQ(rest.kinetic_energy, 0);
  EXPECT_LT(rest.max_penetration, 0.15);
  world.step(5);
  EXPECT_EQ(world.state_hash(), hash);

  // The topmost body is thrown down at one corner.
  RunState thrown = world.state();
  const auto& at = thrown.bodies.position;
  const auto top = static_cast<std::size_t>(
      std::ranges::max_element(at, {}, [](const Vector3d& x) { return x.z(); }) - at.begin());
  thrown.bodies.position[top] = Vector3d(1, 1, 12);
  thrown.bodies.velocity[top] = Vector3d(0, 0, -10);
  thrown.warm_start.sleep_timer[top] = 0;
  World other(scene, options());
  other.restore(thrown);
  int awake = 1;
  for (int step = 0; step < 40 && awake == 1; ++step) {
    other.step();
    awake = 5000 - count_asleep(other);
  }
  EXPECT_GT(awake, 2500) << "most are one island, and wake as one";
  EXPECT_LT(awake, 5000) << "some lie by themselves, and sleep on";
  other.step(3);
  const std::vector<bool> asleep = bodies_asleep(other);
  const BodyStates after = other.bodies();
  for (std::size_t i = 0; i < 5000; ++i) EXPECT_TRUE(!asleep[i] || after.position[i] == at[i]) << i;
  EXPECT_GT(other.measure().kinetic_energy, 0);
}

}  // namespace
}  // namespace collidoscope
