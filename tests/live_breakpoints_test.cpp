// Tests the stops of a live run: break conditions, findings of guards, and how the run continues.

#include "viewer/session/live_breakpoints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/scene_file.h"
#include "tests/executors.h"
#include "tests/falling_scene.h"

namespace collidoscope {
namespace {

struct Watched {
  explicit Watched(const std::string& guards = "")
      : live(parse_scene(falling_scene(guards), "falling"), on_cpu(1)) {}
  bool step() {
    breaks.before_step(live, conditions);
    live.step(true);
    return breaks.after_step(live, conditions);
  }
  const StopView& to_a_stop() {
    for (int k = 0; k < 100; ++k)
      if (step()) return *breaks.stop(live);
    throw std::runtime_error("it does not stop");
  }
  LiveWorld live;
  LiveBreakpoints breaks;
  BreakConditions conditions;
};

TEST(LiveBreakpoints, StopsWhereAConditionIsMet) {
  Watched run;
  run.conditions.limit(BreakCondition::speed) = 5.5;
  const StopView& stop = run.to_a_stop();
  EXPECT_EQ(run.live.world().steps(), 5) << "the state that meets it can be seen";
  EXPECT_FALSE(stop.is_violation);
  EXPECT_EQ(stop.body, 1u);
  EXPECT_TRUE(stop.can_freeze);
  EXPECT_EQ(stop.state_before, 4);
  EXPECT_THAT(stop.what, testing::HasSubstr("speed"));

  // snapshot_before() returns the state before the step and does not change the run.
  const std::uint64_t hash = run.live.world().state_hash();
  const Snapshot before = run.breaks.snapshot_before(run.live);
  EXPECT_EQ(before.state.steps, 4);
  EXPECT_EQ(run.live.world().steps(), 5);
  EXPECT_EQ(run.live.world().state_hash(), hash);
  World again = world_from(before, before.scene, on_cpu(1));
  again.step();
  EXPECT_EQ(again.state_hash(), hash);

  // After resume(), a condition that stays true does not stop the run again.
  run.breaks.resume();
  for (int k = 0; k < 5; ++k) EXPECT_FALSE(run.step());
  run.conditions.limit(BreakCondition::speed) = 15.5;
  EXPECT_FALSE(run.step()) << "now it does not hold";
  run.to_a_stop();
  EXPECT_EQ(run.live.world().steps(), 15);
}

TEST(LiveBreakpoints, AsksNothingWhereAllIsOff) {
  Watched run;
  for (int k = 0; k < 50; ++k) EXPECT_FALSE(run.step());
  EXPECT_FALSE(run.breaks.stop(run.live));
  EXPECT_THROW(run.breaks.snapshot_before(run.live), InputError);
}

TEST(LiveBreakpoints, StopsAtWhatGuardsFindAndFreezesIt) {
  Watched run(R"({"on_failure": "pause", "speed": 5.5})");
  const StopView stop = run.to_a_stop();
  EXPECT_TRUE(stop.is_violation);
  EXPECT_EQ(stop.body, 1u);
  EXPECT_EQ(stop.state_before, 4);
  EXPECT_EQ(run.live.world().steps(), 4) << "the step that fails is in no state";
  EXPECT_EQ(run.live.history().size(), 4u);
  EXPECT_EQ(run.breaks.snapshot_before(run.live).state.steps, 4);
  const Vector3d where = run.live.world().bodies().position[1];
  run.live.freeze(1);
  EXPECT_FALSE(run.breaks.stop(run.live)) << "another run";
  EXPECT_TRUE(run.live.edited());
  EXPECT_THAT(run.live.changes_text(), testing::HasSubstr("{\"step\": 4, \"freeze\": [1]}"));
  EXPECT_FALSE(run.step());
  EXPECT_EQ(run.live.world().bodies().position[1], where);
  EXPECT_EQ(run.to_a_stop().body, 0u);
  EXPECT_THAT(run.live.world().validation().frozen(), testing::ElementsAre(1));
  run.live.restart();
  EXPECT_THAT(run.live.world().validation().frozen(), testing::IsEmpty());
}

TEST(LiveBreakpoints, GuardsAreASettingThatKeepsTheScenesLimits) {
  Watched run(R"({"on_failure": "pause", "speed": 5.5})");
  run.step();
  Settings request = run.live.settings();
  EXPECT_EQ(request.guards, OnFailure::pause);
  const std::uint64_t hash = run.live.state_hash();
  request.guards.reset();
  run.live.apply(request);
  EXPECT_FALSE(run.live.world().effects().guards);
  EXPECT_FALSE(run.live.edited()) << "guards decide nothing";
  EXPECT_EQ(run.live.state_hash(), hash);
  request = run.live.settings();
  request.guards = OnFailure::freeze;
  run.live.apply(request);
  EXPECT_EQ(run.live.settings().guards, OnFailure::freeze);
  for (int k = 0; k < 4; ++k) EXPECT_FALSE(run.step()) << "it freezes and goes on";
  EXPECT_EQ(run.live.world().steps(), 5);
  EXPECT_THAT(run.live.world().validation().frozen(), testing::ElementsAre(1));
}

}  // namespace
}  // namespace collidoscope
