// Tests settings that change while a world runs: which of them may change the result, and which may not.

#include "viewer/session/live_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/limits.h"
#include "tests/live_edits.h"

namespace collidoscope {
namespace {

TEST(LiveWorld, WhatIsNotPhysicsNeverReachesTheState) {
  World straight(live_box(400), on_cpu());
  straight.step(12);
  LiveWorld live(live_box(400), on_cpu());
  for (int k = 0; k < 12; ++k) {
    change_settings(live, [&](Settings& s) {
      if (k % 3 == 0) s.run.shape = {1 + k, 32 << (k % 4)};
      if (k % 3 == 1)
        s.run.broad_phase = broad_phase_names()[static_cast<std::size_t>(k) % broad_phase_names().size()];
      if (k % 5 == 4) s.run.shape = {};
    });
    live.step(k % 2 == 0);
  }
  EXPECT_EQ(live.state_hash(), straight.state_hash());
  EXPECT_FALSE(live.edited());
  EXPECT_EQ(live.history().size(), 12u);
}

TEST(LiveWorld, ANewNKeepsSurvivors) {
  LiveWorld live(live_box(300), on_cpu());
  for (int k = 0; k < 5; ++k) live.step(false);
  const BodyStates before = live.world().bodies();
  EXPECT_EQ(change_settings(live, [](Settings& s) { s.generator.count = 400; }), "");
  const BodyStates after = live.world().bodies();
  ASSERT_EQ(after.position.size(), 400u);
  for (std::size_t i = 0; i < 300; ++i) EXPECT_EQ(before.position[i], after.position[i]) << i;
  EXPECT_EQ(live.world().steps(), 5);
  EXPECT_TRUE(live.edited());
  live.restart();
  EXPECT_FALSE(live.edited());
  EXPECT_EQ(live.world().steps(), 0);
  World fresh(live_box(400), on_cpu());
  fresh.step();
  live.step(true);
  EXPECT_EQ(live.state_hash(), fresh.state_hash());
}

TEST(LiveWorld, ABoxThatGoesWithNStartsAgainAndSaysSo) {
  LiveWorld live(live_box(4000, Variant::scaled), on_cpu());
  live.step(false);
  EXPECT_THAT(change_settings(live, [](Settings& s) { s.generator.count = 5000; }),
              testing::HasSubstr("restarted"));
  EXPECT_EQ(live.world().steps(), 0);
  EXPECT_EQ(live.history().size(), 0u);
  // Below about 2,292 bodies the box stays 100 m wide.
  LiveWorld small(live_box(500, Variant::scaled), on_cpu());
  small.step(false);
  EXPECT_EQ(change_settings(small, [](Settings& s) { s.generator.count = 600; }), "");
  EXPECT_EQ(small.world().steps(), 1);
}

TEST(LiveWorld, OtherBodiesStartAgain) {
  LiveWorld live(live_box(100), on_cpu());
  live.step(false);
  EXPECT_THAT(change_settings(live, [](Settings& s) { s.generator.seed = 9; }),
              testing::HasSubstr("restarted"));
  EXPECT_EQ(live.world().steps(), 0);
  change_settings(live, [](Settings& s) { s.generator.radius_max = 2; });
  for (double radius : live.world().initial().radius) EXPECT_LE(radius, 2);
}

TEST(LiveWorld, PhysicsActAtTheNextStepAndMarkTheRun) {
  LiveWorld live(live_box(100), on_cpu());
  change_settings(live, [](Settings& s) { s.material.restitution = 0.5; });
  EXPECT_FALSE(live.edited()) << "nothing has happened yet";
  live.step(false);
  change_settings(live, [](Settings& s) { s.physics.time_step = 0.01; });
  EXPECT_TRUE(live.edited());
  EXPECT_EQ(live.world().scene().physics.time_step, 0.01);
  EXPECT_EQ(live.world().steps(), 1);
  change_settings(live, [](Settings& s) { s.physics.precision = Precision::f64; });
  live.step(true);
  EXPECT_EQ(live.world().steps(), 2);
}

TEST(LiveWorld, WhatIsRefusedChangesNothing) {
  LiveWorld live(live_box(100), on_cpu());
  live.step(false);
  const std::uint64_t hash = live.state_hash();
  const Settings before = live.settings();
  const auto refused = [&](auto edit) {
    Settings request = before;
    edit(request);
    EXPECT_ANY_THROW(live.apply(request));
    EXPECT_EQ(live.settings(), before);
    EXPECT_EQ(live.state_hash(), hash);
  };
  refused([](Settings& s) { s.run.broad_phase = "none such"; });
  refused([](Settings& s) { s.physics.time_step = -1; });
  refused([](Settings& s) { s.physics.substeps = 0; });
  refused([](Settings& s) { s.physics.iterations = limits::max_iterations + 1; });
  if (!cuda_available()) refused([](Settings& s) { s.run.executor = ExecutorKind::cuda; });
  live.step(true);
  EXPECT_EQ(live.world().steps(), 2);
}

TEST(LiveWorld, PairsAndContactsOfANewStateAreKnownAtOnce) {
  Scene scene = live_box(150);
  scene.box->max = Vector3d(25, 25, 25);
  scene.generators[0].radius_max = 3;
  LiveWorld live(scene, on_cpu());
  for (int k = 0; k < 5; ++k) live.step(true);
  ASSERT_GT(live.stats().speculative, 0);
  const auto detected = [&] {
    World world(live.world().scene(), on_cpu());
    world.restore(live.world());
    world.detect();
    return static_cast<std::int64_t>(world.pairs().size());
  };
  Body ball;
  ball.position = live.world().bodies().position[40];
  live.apply(add_body(ball));
  const StepStats with = live.stats();
  EXPECT_EQ(with.pairs, detected());
  EXPECT_GT(with.speculative, 0);
  live.apply(remove_body(150));
  EXPECT_EQ(live.stats().pairs, detected());
  EXPECT_LT(live.stats().pairs, with.pairs);
  EXPECT_LT(live.stats().speculative, with.speculative);
  EXPECT_GT(live.stats().speculative, 0);
}

TEST(LiveWorld, HistoryKnowsBothKindsOfTimes) {
  LiveWorld live(live_box(200), on_cpu());
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
