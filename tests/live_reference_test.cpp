// Tests the live reference: its kind, the settings that restart it, and its end. Expected offsets come from
// formulas for the error of Euler's method in free flight.

#include "viewer/session/live_reference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/executors.h"
#include "tests/scenes.h"
#include "viewer/session/live_world.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

constexpr double no_limit = std::numeric_limits<double>::infinity();

/// A run with a reference beside it.
struct Beside {
  explicit Beside(const Scene& scene) : live(scene, on_cpu()) {
    reference.follow(live.world(), live.generation());
  }
  void step(int count, double slice = no_limit) {
    for (int k = 0; k < count; ++k) {
      const double dt = live.world().scene().physics.time_step;
      while (!reference.advance_to_next_step(dt, slice)) ++waits;
      live.step(false);
      reference.stepped(dt);
    }
  }
  template <class Edit>
  void change(Edit edit) {
    Settings request = live.settings();
    edit(request);
    live.apply(request);
    reference.follow(live.world(), live.generation());
  }
  std::vector<GhostInstance> ghosts() { return reference.ghosts(live.world(), live.generation()); }
  LiveWorld live;
  LiveReference reference;
  int waits = 0;
};

/// Free flight under gravity, in double, by Euler's method.
Scene flight() {
  Scene scene = hard_space(Vector3d(0, 0, -10));
  scene.physics.solver = Solver::impulse;
  scene.physics.integrator = Integrator::semi_implicit_euler;
  scene.physics.time_step = 1.0 / 64;
  scene.bodies = {sphere(1, {0, 0, 0}, {3, 0, 20}), sphere(2, {0, 50, 0})};
  return scene;
}

TEST(LiveReference, OfHardSpheresIsExact) {
  Beside run(flight());
  EXPECT_EQ(run.reference.view().name, "event-driven hard spheres");
  EXPECT_EQ(run.ghosts()[0].offset[2], 0);
  run.step(32);
  const std::vector<GhostInstance> ghosts = run.ghosts();
  ASSERT_EQ(ghosts.size(), 2u);
  const double off = 0.5 * 10 * (1.0 / 64) * 0.5;  // g h t / 2: the error of Euler's method
  for (const GhostInstance& ghost : ghosts) {
    EXPECT_NEAR(ghost.offset[2], off, 1e-8);
    EXPECT_NEAR(ghost.offset[0], 0, 1e-12);
    EXPECT_EQ(ghost.opacity, 1);
  }
  EXPECT_EQ(ghosts[1].radius, 2);
  EXPECT_NEAR(ghosts[0].body[0], 1.5, 1e-6);
  EXPECT_NEAR(run.reference.view().rms, off, 1e-8);
  EXPECT_NEAR(run.reference.view().max, off, 1e-8);
  EXPECT_EQ(run.reference.view().error_estimate, 0);
  EXPECT_THAT(run.live.world().publisher().errors(),
              testing::Each(testing::FloatNear(static_cast<float>(off), 1e-6f)));
}

TEST(LiveReference, OfOtherScenesIsFinerAndKnowsHowFine) {
  Scene scene = flight();
  scene.physics.solver = Solver::soft_step;
  scene.physics.substeps = 1;
  scene.physics.drag.viscosity = 1e-9;  // excludes the event-driven reference; the force is negligible
  Beside run(scene);
  EXPECT_THAT(run.reference.view().name, HasSubstr("1/8"));
  run.step(32, 0);
  EXPECT_GT(run.waits, 0) << "it goes in slices";
  const std::vector<GhostInstance> ghosts = run.ghosts();
  const double off = 0.5 * 10 * (1.0 / 64) * 0.5;
  EXPECT_NEAR(ghosts[0].offset[2], off * 7 / 8, 1e-6);
  EXPECT_NEAR(run.reference.view().error_estimate, off / 8, 1e-6);
}

TEST(LiveReference, GoesOnWhateverNumericalSettingsTurn) {
  Beside run(flight());
  run.step(16);
  run.change([](Settings& s) { s.physics.time_step = 1.0 / 128; });
  run.change([](Settings& s) { s.physics.precision = Precision::f32; });
  run.change([](Settings& s) { s.physics.iterations = 3; });
  run.step(32);
  EXPECT_EQ(run.reference.view().start_state, 0);
  // A quarter of a second at each step length.
  const double off = 0.5 * 10 * 0.25 * (1.0 / 64 + 1.0 / 128);
  EXPECT_NEAR(run.ghosts()[0].offset[2], off, 1e-4);

  run.change([](Settings& s) { s.material.restitution = 0.5; });
  EXPECT_EQ(run.reference.view().start_state, 48) << "another motion is asked for";
  EXPECT_EQ(run.ghosts()[0].offset[2], 0);
  run.live.restart();
  run.reference.follow(run.live.world(), run.live.generation());
  EXPECT_EQ(run.reference.view().start_state, 0);
}

// The finer runs also change their step length, from their current states.
TEST(LiveReference, RunsFollowAnotherStep) {
  Scene scene = flight();
  scene.physics.solver = Solver::soft_step;
  scene.physics.substeps = 1;
  scene.physics.drag.viscosity = 1e-9;
  Beside run(scene);
  run.step(16);
  run.change([](Settings& s) { s.physics.time_step = 1.0 / 96; });
  run.step(24);
  EXPECT_EQ(run.reference.view().start_state, 0);
  // The reference step changes from 1/8 of the first step to 1/5 of the second, the nearest divisor.
  const double off = 0.5 * 10 * 0.25 * (1.0 / 64 - 1.0 / 512 + 1.0 / 96 - 1.0 / 480);
  EXPECT_NEAR(run.ghosts()[0].offset[2], off, 1e-6);
}

TEST(LiveReference, EndsWhereNothingIsExactAnyMore) {
  Scene ball = hard_space(Vector3d(0, 0, -10), 0.3);
  ball.physics.time_step = 0.05;
  ball.bodies = {sphere(1, {0, 0, 1.5})};
  ball.obstacles = {Plane{}};
  Beside run(ball);
  run.step(40);
  EXPECT_TRUE(run.ghosts().empty());
  EXPECT_THAT(run.reference.view().unavailable_reason, HasSubstr("Zeno point"));
  EXPECT_TRUE(run.live.world().publisher().errors().empty());
  run.step(3);  // the run continues without the reference
  EXPECT_FALSE(run.reference.view().known());

  EXPECT_EQ(LiveReference::unavailable_reason(2000), "");
  EXPECT_THAT(LiveReference::unavailable_reason(LiveReference::max_bodies + 1), HasSubstr("50000"));
}

// The drawn bodies may differ from those of the last follow(): a step plays changes of the run, and another
// scene can be opened at any time.
TEST(LiveReference, NeverSpeaksOfBodiesThatAreGone) {
  for (const double viscosity : {0.0, 1e-9}) {  // with the exact reference, and without it
    Scene scene = flight();
    scene.physics.drag.viscosity = viscosity;
    Beside run(scene);
    run.step(4);
    EXPECT_EQ(run.ghosts().size(), 2u);
    for (const int bodies : {300, 2, 1}) {
      Scene other = scene;
      other.bodies.assign(static_cast<std::size_t>(bodies), sphere(1, {0, 0, 0}));
      for (int k = 0; k < bodies; ++k) other.bodies[static_cast<std::size_t>(k)].position.x() = 3.0 * k;
      run.live.open(World(other, on_cpu()));
      const std::vector<GhostInstance> ghosts = run.ghosts();
      ASSERT_EQ(std::ssize(ghosts), bodies);
      for (const GhostInstance& ghost : ghosts) EXPECT_EQ(ghost.offset[0], 0);
      EXPECT_EQ(std::ssize(run.live.world().publisher().errors()), bodies);
    }
  }
}

TEST(LiveReference, NeverTouchesTheRun) {
  Scene scene = box_collider(120);
  scene.physics.solver = Solver::soft_step;
  World alone(scene, on_cpu());
  alone.step(20);
  Beside run(scene);
  for (int k = 0; k < 20; ++k) {
    run.step(1);
    run.ghosts();
  }
  EXPECT_EQ(run.live.state_hash(), alone.state_hash());
  EXPECT_GT(run.reference.view().rms, 0);
  const int version = run.reference.version();
  run.reference.forget();
  EXPECT_TRUE(run.reference.view().name.empty());
  EXPECT_NE(run.reference.version(), version);
}

}  // namespace
}  // namespace collidoscope
