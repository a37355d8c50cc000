// A study of a running scene in slices: what it starts from, what it survives, what it says.

#include "viewer/session/live_accuracy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/executors.h"
#include "tests/scenes.h"
#include "viewer/session/live_world.h"

namespace collidoscope {
namespace {

Scene one_ball() {
  Scene scene = hard_space(Vector3d(0, 0, -10));
  scene.physics.time_step = 1.0 / 32;
  scene.bodies = {sphere(1, {0, 0, 0}, {3, 0, 5})};
  return scene;
}

struct Studied {
  explicit Studied(const Scene& scene) : live(scene, on_cpu(1)) {}
  const AccuracyFacts& frame(double milliseconds = 5) {
    study.follow(live.world(), live.generation(), wishes);
    study.go_on(milliseconds);
    return study.facts(live.world(), wishes);
  }
  const AccuracyFacts& to_the_end() {
    while (frame(), !study.done()) ++frames;
    return frame();
  }
  LiveWorld live;
  LiveAccuracy study;
  AccuracyWishes wishes;
  int frames = 0;
};

TEST(LiveAccuracy, FindsTheCheapestBelowATolerance) {
  Studied ball(one_ball());
  ball.live.step(false);
  const std::uint64_t before = ball.live.state_hash();
  const AccuracyFacts& facts = ball.to_the_end();
  EXPECT_EQ(facts.lack, "");
  EXPECT_EQ(facts.since, 1);
  EXPECT_EQ(facts.done, 1);
  EXPECT_EQ(facts.doing, "");
  ASSERT_TRUE(facts.reference);
  EXPECT_EQ(facts.reference->kind, AccuracyReference::Kind::hard_spheres);
  ASSERT_FALSE(facts.points.empty());
  EXPECT_TRUE(
      std::ranges::all_of(facts.points, [](const auto& p) { return p.has_error() && p.has_price(); }));
  EXPECT_EQ(std::ranges::count(facts.points, facts.now, &AccuracyPoint::setting), 1)
      << "the run's own is among them";
  EXPECT_GT(ball.wishes.tolerance, 0) << "one to begin with";
  ASSERT_TRUE(facts.cheapest);
  for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
    ball.wishes.tolerance = tolerance;
    const AccuracyFacts& answer = ball.frame();
    EXPECT_EQ(answer.cheapest, cheapest_below(answer.points, tolerance));
  }
  EXPECT_EQ(ball.live.state_hash(), before) << "the run was not touched";
}

TEST(LiveAccuracy, BeginsAnewWhereTheRunIsAskedSomethingElse) {
  Studied ball(one_ball());
  ball.to_the_end();
  const auto change = [&](auto edit) {
    Settings wish = ball.live.settings();
    edit(wish);
    ball.live.apply(wish);
    return ball.frame(0).done;
  };
  ball.live.step(false);
  EXPECT_EQ(ball.frame(0).done, 1) << "the run goes on";
  EXPECT_EQ(change([](Settings& s) { s.physics.time_step = 1.0 / 64; }), 1) << "a setting that is varied";
  EXPECT_EQ(ball.frame(0).now.time_step, 1.0 / 64);
  EXPECT_LT(change([](Settings& s) { s.material.restitution = 0.5; }), 1);
  EXPECT_EQ(ball.frame(0).since, 1);
  ball.to_the_end();
  ball.live.step(false);
  ball.wishes.restart = true;
  EXPECT_LT(ball.frame(0).done, 1);
  EXPECT_FALSE(ball.wishes.restart);
  EXPECT_EQ(ball.frame(0).since, 2);
}

TEST(LiveAccuracy, SaysWhyNothingCanBeMeasured) {
  Scene scene = hard_space();
  Studied nothing(scene);
  EXPECT_NE(nothing.frame().lack, "");
  EXPECT_TRUE(nothing.study.done());
}

}  // namespace
}  // namespace collidoscope
