// Tests an accuracy study in slices beside a running scene: its start state, the changes that restart it, and
// its messages.

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
  const AccuracyView& frame(double milliseconds = 5) {
    study.follow(live.world(), live.generation(), requests);
    study.advance(milliseconds);
    return study.view(live.world(), requests);
  }
  const AccuracyView& to_the_end() {
    while (frame(), !study.done()) ++frames;
    return frame();
  }
  LiveWorld live;
  LiveAccuracy study;
  AccuracyRequests requests;
  int frames = 0;
};

TEST(LiveAccuracy, FindsTheCheapestBelowATolerance) {
  Studied ball(one_ball());
  ball.live.step(false);
  const std::uint64_t before = ball.live.state_hash();
  const AccuracyView& view = ball.to_the_end();
  EXPECT_EQ(view.unavailable_reason, "");
  EXPECT_EQ(view.start_state, 1);
  EXPECT_EQ(view.done, 1);
  EXPECT_EQ(view.current_task, "");
  ASSERT_TRUE(view.reference);
  EXPECT_EQ(view.reference->kind, AccuracyReference::Kind::hard_spheres);
  ASSERT_FALSE(view.points.empty());
  EXPECT_TRUE(std::ranges::all_of(view.points, [](const auto& p) { return p.has_error() && p.has_cost(); }));
  EXPECT_EQ(std::ranges::count(view.points, view.now, &AccuracyPoint::setting), 1)
      << "the run's own is among them";
  EXPECT_GT(ball.requests.tolerance, 0) << "one to begin with";
  ASSERT_TRUE(view.cheapest);
  for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
    ball.requests.tolerance = tolerance;
    const AccuracyView& answer = ball.frame();
    EXPECT_EQ(answer.cheapest, cheapest_below(answer.points, tolerance));
  }
  EXPECT_EQ(ball.live.state_hash(), before) << "the run was not touched";
}

TEST(LiveAccuracy, BeginsAnewWhereTheRunIsAskedSomethingElse) {
  Studied ball(one_ball());
  ball.to_the_end();
  const auto change = [&](auto edit) {
    Settings request = ball.live.settings();
    edit(request);
    ball.live.apply(request);
    return ball.frame(0).done;
  };
  ball.live.step(false);
  EXPECT_EQ(ball.frame(0).done, 1) << "the run goes on";
  EXPECT_EQ(change([](Settings& s) { s.physics.time_step = 1.0 / 64; }), 1) << "a setting that is varied";
  EXPECT_EQ(ball.frame(0).now.time_step, 1.0 / 64);
  EXPECT_LT(change([](Settings& s) { s.material.restitution = 0.5; }), 1);
  EXPECT_EQ(ball.frame(0).start_state, 1);
  ball.to_the_end();
  ball.live.step(false);
  ball.requests.restart = true;
  EXPECT_LT(ball.frame(0).done, 1);
  EXPECT_FALSE(ball.requests.restart);
  EXPECT_EQ(ball.frame(0).start_state, 2);
}

TEST(LiveAccuracy, SaysWhyNothingCanBeMeasured) {
  Scene scene = hard_space();
  Studied nothing(scene);
  EXPECT_NE(nothing.frame().unavailable_reason, "");
  EXPECT_TRUE(nothing.study.done());
}

}  // namespace
}  // namespace collidoscope
