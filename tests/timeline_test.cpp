// Tests the timeline: every state of a run is reached again bit for bit, within a memory budget, and changes
// in earlier states start a branch.

#include "sim_cuda/recording/timeline.h"

#include <gmock/gmock.h>

#include <map>

#include "sim_cuda/core/error.h"
#include "tests/executors.h"
#include "tests/random.h"
#include "tests/scenes.h"
#include "viewer/session/live_world.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Scene tumbling_scene(std::int64_t bodies = 80) {
  Scene scene = box_collider(bodies);
  scene.box->max = Vector3d(20, 20, 20);
  scene.generators[0].radius_max = 3;
  scene.generators[0].speed_max = 4;
  scene.generators[0].spawn = Spawn::inside;
  scene.materials[0].friction = 0.4;
  scene.physics.solver = Solver::soft_step;
  scene.physics.sleep = Sleep{};
  return scene;
}

Change restitution_of(double value) {
  Change change;
  change.settings.set<&Material::restitution>(value);
  return change;
}

std::vector<std::int64_t> changed_states(const Timeline& timeline) {
  std::vector<std::int64_t> states;
  for (const Timeline::Keyframe& keyframe : timeline.keyframes())
    if (timeline.is_change(keyframe.state())) states.push_back(keyframe.state());
  return states;
}

class Timelines : public OnEachExecutor {};
ON_EACH_EXECUTOR(Timelines);

TEST_P(Timelines, ReachEveryStateAgain) {
  LiveWorld live(tumbling_scene(), options());
  std::vector<std::uint64_t> hashes{live.state_hash()};
  std::vector<std::uint64_t> full{full_hash(live.world().state())};
  constexpr std::int64_t steps = 150;
  for (std::int64_t step = 1; step <= steps; ++step) {
    ASSERT_TRUE(live.step(step % 2 == 0));
    if (step == 40) {
      Change change;
      change.remove = {3, 17};
      live.apply(std::move(change));
    }
    if (step == 90) live.apply(restitution_of(0.9));
    hashes.push_back(live.state_hash());
    full.push_back(full_hash(live.world().state()));
  }
  EXPECT_EQ(live.timeline().first(), 0);
  EXPECT_EQ(live.timeline().last(), steps);
  EXPECT_THAT(changed_states(live.timeline()), ElementsAre(40, 90));
  EXPECT_EQ(live.changes().size(), 2u);
  Random random(7);
  for (int k = 0; k < 60; ++k) {
    const auto step = static_cast<std::int64_t>(random() % (steps + 1));
    live.go_to(step);
    ASSERT_EQ(live.world().steps(), step);
    EXPECT_EQ(live.state_hash(), hashes[static_cast<std::size_t>(step)]) << step;
    EXPECT_EQ(full_hash(live.world().state()), full[static_cast<std::size_t>(step)]) << step;
    EXPECT_EQ(live.world().initial().size(), step < 40 ? 80u : 78u) << step;
  }
  // Steps from an early state go through the same states, over both changes, and on from the last one.
  live.go_to(20);
  for (std::int64_t step = 21; step <= steps; ++step) {
    ASSERT_TRUE(live.step(true));
    EXPECT_EQ(live.state_hash(), hashes[static_cast<std::size_t>(step)]) << step;
  }
  EXPECT_EQ(live.history().size(), static_cast<std::size_t>(steps)) << "known steps are not added again";
  EXPECT_EQ(live.changes().size(), 2u);
  ASSERT_TRUE(live.step(true));
  EXPECT_EQ(live.timeline().last(), steps + 1);
  EXPECT_EQ(live.history().size(), static_cast<std::size_t>(steps) + 1);
}

TEST_P(Timelines, AChangeInAnEarlierStateStartsABranch) {
  LiveWorld live(tumbling_scene(), options());
  for (int step = 1; step <= 60; ++step) live.step(true);
  live.apply(restitution_of(0.1));
  for (int step = 61; step <= 80; ++step) live.step(true);
  live.go_to(30);
  live.apply(restitution_of(0.9));
  EXPECT_EQ(live.timeline().last(), 30);
  EXPECT_THAT(changed_states(live.timeline()), ElementsAre(30));
  EXPECT_EQ(live.history().size(), 30u);
  ASSERT_EQ(live.changes().size(), 1u) << "that of state 60 never happened";
  EXPECT_EQ(live.changes()[0].step, 30);
  for (int step = 31; step <= 50; ++step) live.step(true);

  World straight(tumbling_scene(), options());
  straight.step(30);
  Change change = restitution_of(0.9);
  change.step = 30;
  const auto other = world_after_change(straight, change, options());
  other->step(20);
  EXPECT_EQ(live.state_hash(), other->state_hash());
  live.go_to(40);
  other->step(5);
  live.go_to(30);
  EXPECT_DOUBLE_EQ(live.world().scene().materials[0].restitution, 0.9) << "after its change";
  // Settings of the execution start no branch.
  live.go_to(20);
  Settings request = live.settings();
  request.run.shape = {2, 8};
  live.apply(request);
  EXPECT_EQ(live.timeline().last(), 50);
  // A restart forgets all.
  live.restart();
  EXPECT_EQ(live.timeline().first(), 0);
  EXPECT_EQ(live.timeline().last(), 0);
}

TEST_P(Timelines, TheRunBeforeABranchIsKept) {
  LiveWorld live(tumbling_scene(), options());
  std::vector<std::uint64_t> first{live.state_hash()};
  for (int step = 1; step <= 60; ++step) {
    if (step == 51) live.apply(restitution_of(0.1));
    live.step(true);
    first.push_back(live.state_hash());
  }
  EXPECT_FALSE(live.other_run());
  live.go_to(30);
  live.apply(restitution_of(0.9));
  for (int step = 31; step <= 40; ++step) live.step(true);
  const std::uint64_t branch = live.state_hash();
  EXPECT_NE(branch, first[40]);
  ASSERT_TRUE(live.other_run());
  EXPECT_EQ(live.other_run()->fork, 30);
  EXPECT_EQ(live.other_run()->last, 60);
  ASSERT_EQ(live.marks().size(), 1u);
  EXPECT_EQ(live.marks()[0].text, "state 30: restitution");

  live.open_other_run();
  EXPECT_EQ(live.state_hash(), first[40]) << "the same state number";
  EXPECT_EQ(live.timeline().last(), 60);
  EXPECT_EQ(live.history().size(), 60u);
  ASSERT_EQ(live.changes().size(), 1u);
  EXPECT_EQ(live.changes()[0].step, 50);
  EXPECT_EQ(live.other_run()->last, 40);
  for (const std::int64_t step : {0, 29, 30, 31, 50, 51, 60}) {
    live.go_to(step);
    EXPECT_EQ(live.state_hash(), first[static_cast<std::size_t>(step)]) << step;
  }
  live.step(true);
  EXPECT_EQ(live.timeline().last(), 61) << "it goes on";

  live.open_other_run();
  EXPECT_EQ(live.world().steps(), 40) << "the last state that it has";
  EXPECT_EQ(live.state_hash(), branch);
  EXPECT_EQ(live.other_run()->last, 61);
  // A replay of its changes reaches the same state.
  Scene scene = tumbling_scene();
  LiveWorld again(scene, options());
  for (int step = 1; step <= 30; ++step) again.step(false);
  again.apply(live.changes().at(0));
  for (int step = 31; step <= 40; ++step) again.step(false);
  EXPECT_EQ(again.state_hash(), branch);
  live.restart();
  EXPECT_FALSE(live.other_run());
}

TEST_P(Timelines, GoBackThroughEveryState) {
  LiveWorld live(tumbling_scene(), options());
  std::vector<std::uint64_t> full{full_hash(live.world().state())};
  constexpr std::int64_t last = 130;
  for (std::int64_t step = 1; step <= last; ++step) {
    live.step(false);
    if (step == 70) live.apply(restitution_of(0.9));
    full.push_back(full_hash(live.world().state()));
  }
  for (const std::int64_t stride : {1, 3}) {
    for (std::int64_t step = last; step >= 0; step -= stride) {
      live.go_to(step);
      ASSERT_EQ(full_hash(live.world().state()), full[static_cast<std::size_t>(step)]) << step;
      if (step == 40) {  // on from here, with states that were kept on the way
        live.step(false);
        EXPECT_EQ(full_hash(live.world().state()), full[41]);
      }
    }
  }
}

TEST_P(Timelines, KeepWithinTheirBudget) {
  World world(tumbling_scene(), options());
  Timeline timeline(150'000);
  timeline.begin(world);
  const std::int64_t one = timeline.bytes();
  ASSERT_LT(one, 15'000);
  std::vector<std::uint64_t> hashes{world.state_hash()};
  for (int step = 1; step <= 300; ++step) {
    world.step();
    timeline.record_step(world, 0.1);  // as if a step took so long
    hashes.push_back(world.state_hash());
    EXPECT_LE(timeline.bytes(), 150'000) << step;
  }
  EXPECT_GT(timeline.keyframes().size(), 4u);
  EXPECT_LT(timeline.keyframes().size(), 300u / 3) << "some were removed";
  for (const std::int64_t step : {0, 1, 7, 150, 151, 299, 300})
    EXPECT_EQ(timeline.world_at(step, options())->state_hash(), hashes[static_cast<std::size_t>(step)])
        << step;
}

TEST_P(Timelines, ForgetTheOldestStatesIfChangesExceedTheBudget) {
  World world(tumbling_scene(), options());
  Timeline timeline(30'000);
  timeline.begin(world);
  std::vector<std::uint64_t> hashes{world.state_hash()};
  for (int step = 1; step <= 60; ++step) {
    world.step();
    timeline.record_step(world, step % 2 == 0 ? 100 : 0.001);  // keyframes between changes, too
    hashes.push_back(world.state_hash());
    if (step % 3 == 0) timeline.record_change(world);  // a change that keeps the state
    EXPECT_LE(timeline.bytes(), 30'000) << step;
  }
  EXPECT_GT(timeline.first(), 3);
  EXPECT_EQ(timeline.last(), 60);
  for (std::int64_t step = timeline.first(); step <= 60; ++step)
    EXPECT_EQ(timeline.world_at(step, options())->state_hash(), hashes[static_cast<std::size_t>(step)])
        << step;
}

TEST_P(Timelines, TellOfAStateThatDiffers) {
  World world(tumbling_scene(), options()), other(tumbling_scene(60), options());
  Timeline timeline;
  timeline.begin(world);
  for (int step = 1; step <= 5; ++step) {
    world.step();
    other.step();
    timeline.record_step(step == 4 ? other : world, 0.001);  // records a wrong hash of state 4
  }
  EXPECT_EQ(timeline.world_at(5, options())->steps(), 5);
  try {
    timeline.world_at(4, options());
    ADD_FAILURE() << "not found";
  } catch (const MachineError& error) {
    EXPECT_THAT(error.what(), HasSubstr("state 4 reached again has the hash "));
  }
}

/// Equal bodies, but other warm-start data.
TEST_P(Timelines, TellOfWarmStartDataThatDiffer) {
  World world(tumbling_scene(), options());
  Timeline timeline;
  timeline.begin(world);
  world.step(30);
  RunState state = world.state();
  ASSERT_FALSE(state.warm_start.contacts.empty());
  timeline.begin(world);
  world.step();
  const StateHashes right = world.hashes();
  state = world.state();
  state.warm_start.contacts[0].impulse += 1;
  world.restore(state);
  ASSERT_EQ(world.hashes().bodies, right.bodies);
  timeline.record_step(world, 0.001);
  try {
    timeline.world_at(31, options());
    ADD_FAILURE() << "not found";
  } catch (const MachineError& error) {
    EXPECT_THAT(error.what(), HasSubstr(" with warm-start data, before "));
  }
}

TEST(Timelines, GuardsStayAsTheyAreSet) {
  LiveWorld live(tumbling_scene(), on_cpu());
  for (int step = 1; step <= 20; ++step) live.step(true);
  Settings request = live.settings();
  request.guards = OnFailure::pause;
  live.apply(request);
  for (int step = 21; step <= 30; ++step) live.step(true);
  EXPECT_EQ(live.timeline().last(), 30) << "guards do not affect the state";
  live.go_to(10);
  EXPECT_EQ(live.settings().guards, OnFailure::pause);
  live.go_to(30);
  EXPECT_EQ(live.settings().guards, OnFailure::pause);
}

TEST(Timelines, KeepTheLimitsOfGuards) {
  Scene scene = tumbling_scene();
  scene.physics.guards = ValidationSettings{.speed = 900};
  LiveWorld live(scene, on_cpu());
  for (int step = 1; step <= 20; ++step) live.step(true);
  live.go_to(10);
  ASSERT_TRUE(live.world().scene().physics.guards);
  EXPECT_EQ(live.world().scene().physics.guards->speed, 900);
}

}  // namespace
}  // namespace collidoscope
