// Settings turned while a world runs: what they may change of the result, and what not.

#include "viewer/live/live_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

Scene box_of(std::int64_t bodies, Variant variant = Variant::paper) {
  Scene scene;
  scene.box = Box{};
  BoxCollider generator;
  generator.count = bodies;
  generator.variant = variant;
  scene.generators.push_back(generator);
  return scene;
}

RunOptions on_cpu() {
  RunOptions options;
  options.executor = ExecutorKind::cpu;
  return options;
}

template <class Change>
std::string change(LiveWorld& live, Change edit) {
  Settings wish = live.settings();
  edit(wish);
  const std::string said = live.apply(wish);
  EXPECT_EQ(live.settings(), wish);
  return said;
}

TEST(LiveWorld, WhatIsNotPhysicsNeverReachesTheState) {
  World straight(box_of(400), on_cpu());
  straight.step(12);
  LiveWorld live(box_of(400), on_cpu());
  for (int k = 0; k < 12; ++k) {
    change(live, [&](Settings& s) {
      if (k % 3 == 0) s.shape = {1 + k, 32 << (k % 4)};
      if (k % 3 == 1)
        s.broad_phase = broad_phase_names()[static_cast<std::size_t>(k) % broad_phase_names().size()];
      if (k % 5 == 4) s.shape = {};
    });
    live.step(k % 2 == 0);
  }
  EXPECT_EQ(live.state_hash(), straight.state_hash());
  EXPECT_FALSE(live.edited());
  EXPECT_EQ(live.history().size(), 12u);
}

TEST(LiveWorld, ANewNKeepsSurvivors) {
  LiveWorld live(box_of(300), on_cpu());
  for (int k = 0; k < 5; ++k) live.step(false);
  const BodyStates before = live.world().bodies();
  EXPECT_EQ(change(live, [](Settings& s) { s.bodies = 400; }), "");
  const BodyStates after = live.world().bodies();
  ASSERT_EQ(after.position.size(), 400u);
  for (std::size_t i = 0; i < 300; ++i) EXPECT_EQ(before.position[i], after.position[i]) << i;
  EXPECT_EQ(live.world().steps(), 5);
  EXPECT_TRUE(live.edited());
  live.restart();
  EXPECT_FALSE(live.edited());
  EXPECT_EQ(live.world().steps(), 0);
  World fresh(box_of(400), on_cpu());
  fresh.step();
  live.step(true);
  EXPECT_EQ(live.state_hash(), fresh.state_hash());
}

TEST(LiveWorld, ABoxThatGoesWithNStartsAgainAndSaysSo) {
  LiveWorld live(box_of(4000, Variant::scaled), on_cpu());
  live.step(false);
  EXPECT_THAT(change(live, [](Settings& s) { s.bodies = 5000; }), testing::HasSubstr("restarted"));
  EXPECT_EQ(live.world().steps(), 0);
  EXPECT_EQ(live.history().size(), 0u);
  // Below about 2,292 bodies the box stays 100 m wide.
  LiveWorld small(box_of(500, Variant::scaled), on_cpu());
  small.step(false);
  EXPECT_EQ(change(small, [](Settings& s) { s.bodies = 600; }), "");
  EXPECT_EQ(small.world().steps(), 1);
}

TEST(LiveWorld, OtherBodiesStartAgain) {
  LiveWorld live(box_of(100), on_cpu());
  live.step(false);
  EXPECT_THAT(change(live, [](Settings& s) { s.seed = 9; }), testing::HasSubstr("restarted"));
  EXPECT_EQ(live.world().steps(), 0);
  change(live, [](Settings& s) { s.radius_max = 2; });
  for (double radius : live.world().initial().radius) EXPECT_LE(radius, 2);
}

TEST(LiveWorld, PhysicsActAtTheNextStepAndMarkTheRun) {
  LiveWorld live(box_of(100), on_cpu());
  change(live, [](Settings& s) { s.restitution = 0.5; });
  EXPECT_FALSE(live.edited()) << "nothing has happened yet";
  live.step(false);
  change(live, [](Settings& s) { s.time_step = 0.01; });
  EXPECT_TRUE(live.edited());
  EXPECT_EQ(live.world().scene().physics.time_step, 0.01);
  EXPECT_EQ(live.world().steps(), 1);
  change(live, [](Settings& s) { s.precision = Precision::f64; });
  live.step(true);
  EXPECT_EQ(live.world().steps(), 2);
}

TEST(LiveWorld, WhatIsRefusedChangesNothing) {
  LiveWorld live(box_of(100), on_cpu());
  live.step(false);
  const std::uint64_t hash = live.state_hash();
  const Settings before = live.settings();
  const auto refused = [&](auto edit) {
    Settings wish = before;
    edit(wish);
    EXPECT_ANY_THROW(live.apply(wish));
    EXPECT_EQ(live.settings(), before);
    EXPECT_EQ(live.state_hash(), hash);
  };
  refused([](Settings& s) { s.broad_phase = "none such"; });
  refused([](Settings& s) { s.time_step = -1; });
  if (!cuda_available()) refused([](Settings& s) { s.executor = ExecutorKind::cuda; });
  live.step(true);
  EXPECT_EQ(live.world().steps(), 2);
}

TEST(LiveWorld, HistoryKnowsBothKindsOfTimes) {
  LiveWorld live(box_of(200), on_cpu());
  for (int k = 0; k < 6; ++k) live.step(true);
  const History& history = live.history();
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(history[i].instrumented(), i % 2 == 1) << i;
    EXPECT_EQ(history[i].plain_ms > 0, i % 2 == 0) << i;
    EXPECT_GT(history[i].nodes, 200);
    EXPECT_EQ(history[i].stats.step, static_cast<std::int64_t>(i) + 1);
  }
  EXPECT_GT(history.stages().size(), 4u);
}

}  // namespace
}  // namespace collidoscope
