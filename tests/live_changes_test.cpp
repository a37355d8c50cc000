// Tests what a live world records of its changes. A run without a window that replays them comes to the same
// state.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim_cuda/core/error.h"
#include "tests/live_edits.h"
#include "tests/random.h"

namespace collidoscope {
namespace {

// Random user actions: the run with a window and the replay from its file must agree.
TEST(LiveChanges, WhatWasDoneIsDoneAgainFromItsFile) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Scene scene = live_box(150);
    scene.box->max = Vector3d(25, 25, 25);
    scene.generators[0].radius_max = 3;
    scene.physics.solver = Solver::soft_step;
    scene.materials[0].friction = 0.5;
    scene.physics.sleep = Sleep{};
    LiveWorld live(scene, on_cpu());
    Random random(seed);
    for (int act = 0; act < 25; ++act) {
      const auto body = static_cast<std::int64_t>(random() % live.world().initial().size());
      try {
        switch (random() % 15) {
          case 0:
            change_settings(live, [&](Settings& s) { s.generator.count = 100 + random() % 100; });
            break;
          case 1:
            change_settings(live, [&](Settings& s) {
              s.run.shape = {1 + static_cast<int>(random() % 40), 32};
            });
            break;
          case 2:
            change_settings(live, [&](Settings& s) { s.material.restitution = (random() % 10) / 10.0; });
            break;
          case 3:
            change_settings(
                live, [&](Settings& s) { s.physics.effects = Effects{.gravity = true, .rotation = true}; });
            break;
          case 4:
            change_settings(live, [&](Settings& s) { s.physics.effects.reset(); });
            break;
          case 5:
            change_settings(live, [&](Settings& s) { s.physics.time_step = 1.0 / (20 + random() % 90); });
            break;
          case 6:
            live.apply(remove_body(body));
            break;
          case 7: {
            Body thrown;
            thrown.radius = 0.1 + (random() % 100) / 37.0;
            thrown.position = Vector3d(12 + (random() % 100) / 33.0, 12, 20);
            thrown.velocity = Vector3d((random() % 100) / 7.0, -3, 1);
            live.apply(add_body(thrown));
            break;
          }
          case 8:
            change_settings(live, [&](Settings& s) {
              s.physics.effects = Effects{.gravity = true};
              s.physics.solver = s.physics.solver == Solver::impulse ? Solver::soft_step : Solver::impulse;
            });
            break;
          case 9:
            if (random() % 3 == 0) live.restart();
            break;
          case 10:
            if (random() % 3 == 0) change_settings(live, [&](Settings& s) { s.generator.seed = random(); });
            break;
          case 11:
            change_settings(live, [&](Settings& s) { s.run.broad_phase = "refit"; });
            break;
          case 12:
            change_settings(live, [&](Settings& s) {
              const int parts = static_cast<int>(random() % 7);
              s.physics.substeps = parts > 0 ? std::optional(parts) : std::nullopt;
            });
            break;
          case 14:
            live.freeze(static_cast<std::uint32_t>(body));
            break;
          case 13:
            change_settings(live,
                            [&](Settings& s) { s.physics.iterations = 1 + static_cast<int>(random() % 3); });
            break;
        }
      } catch (const InputError&) {
        // friction with the solver impulse: refused without a change
      }
      for (unsigned k = random() % 4; k > 0; --k) live.step(false);
    }
    EXPECT_EQ(replayed_hash(live, scene), live.state_hash()) << seed << '\n' << live.changes_text();
  }
}

// "auto" differs from the number that it resolves to, and resolves to another number if the solver changes.
TEST(LiveChanges, SubstepsAndIterationsActAtTheNextStep) {
  Scene scene = live_box(200);
  scene.box->max = Vector3d(25, 25, 25);
  const auto settings_after = [&](auto edit) {
    LiveWorld live(scene, on_cpu());
    live.step(false);
    change_settings(live, edit);
    EXPECT_TRUE(live.edited());
    EXPECT_EQ(live.changes().size(), 1u);
    for (int k = 0; k < 3; ++k) live.step(false);
    EXPECT_EQ(replayed_hash(live, scene), live.state_hash());
    return std::pair(live.world().substeps(), live.state_hash());
  };
  LiveWorld untouched(scene, on_cpu());
  for (int k = 0; k < 4; ++k) untouched.step(false);
  EXPECT_EQ(untouched.world().substeps(), 4);
  const auto four = settings_after([](Settings& s) { s.physics.substeps = 4; });
  EXPECT_EQ(four, std::pair(4, untouched.state_hash()));
  const auto two = settings_after([](Settings& s) { s.physics.substeps = 2; });
  EXPECT_EQ(two.first, 2);
  EXPECT_NE(two.second, untouched.state_hash());
  EXPECT_NE(settings_after([](Settings& s) { s.physics.iterations = 2; }).second, untouched.state_hash());
  EXPECT_EQ(settings_after([](Settings& s) { s.physics.solver = Solver::impulse; }).first, 1);
}

TEST(LiveChanges, ARemovedBodyAndOneThatIsThrown) {
  LiveWorld live(live_box(50), on_cpu());
  live.step(false);
  EXPECT_EQ(live.apply(remove_body(10)), "");
  EXPECT_TRUE(live.edited());
  ASSERT_EQ(live.last_id_map().size(), 50u);
  EXPECT_EQ(live.last_id_map()[10], no_body);
  EXPECT_EQ(live.last_id_map()[11], 10u);
  EXPECT_EQ(live.settings().generator.count, 50) << "of the generator, with what was removed of it";
  Body ball;
  ball.position = Vector3d(50, 50, 50);
  live.apply(add_body(ball));
  EXPECT_EQ(live.world().initial().size(), 50u);
  // The thrown body comes after the generated ones, and its id changes with N.
  change_settings(live, [](Settings& s) { s.generator.count = 60; });
  EXPECT_EQ(live.world().initial().size(), 60u);
  EXPECT_EQ(live.world().initial().radius[59], 1);
  EXPECT_EQ(live.last_id_map()[49], 59u);
  Change too_much;
  too_much.settings.set<&Material::restitution>(2);
  EXPECT_THROW(live.apply(too_much), InputError);
  EXPECT_EQ(live.changes().size(), 3u) << "what is refused is not recorded";
  live.step(true);
  EXPECT_EQ(replayed_hash(live, live_box(50)), live.state_hash());
  LiveWorld untouched(live_box(50), on_cpu());
  untouched.step(false);
  untouched.restart();
  EXPECT_TRUE(untouched.changes().empty());
  LiveWorld loaded{World(untouched.world().scene(), on_cpu())};
  loaded.step(false);
  LiveWorld later(std::move(loaded.world()));
  later.restart();
  ASSERT_EQ(later.changes().size(), 1u) << "the restart of a run from a snapshot is a recorded change";
  EXPECT_EQ(later.changes()[0].step, 0);
}

TEST(LiveChanges, FreezingABodyIsAChange) {
  const Scene scene = live_box(60);
  LiveWorld live(scene, on_cpu());
  for (int k = 0; k < 4; ++k) live.step(false);
  const Vector3d place = live.world().bodies().position[7];
  live.freeze(7);
  EXPECT_TRUE(live.edited());
  ASSERT_EQ(live.changes().size(), 1u);
  EXPECT_EQ(live.changes()[0].step, 4);
  EXPECT_THAT(live.changes()[0].freeze, testing::ElementsAre(7));
  // The frozen body keeps its position through all later changes.
  live.apply(remove_body(3));
  change_settings(live, [](Settings& s) { s.material.restitution = 0.5; });
  for (int k = 0; k < 6; ++k) live.step(false);
  EXPECT_THAT(live.world().validation().frozen(), testing::ElementsAre(6))
      << "ids above the removed one move down";
  EXPECT_EQ(live.world().bodies().position[6], place);
  EXPECT_EQ(replayed_hash(live, scene), live.state_hash());
  live.restart();
  EXPECT_TRUE(live.world().validation().frozen().empty());
  ASSERT_EQ(live.changes().size(), 1u);
  EXPECT_TRUE(live.changes()[0].freeze.empty()) << "a start at state 0 frees what was frozen";
  live.step(false);
  EXPECT_EQ(replayed_hash(live, scene), live.state_hash());
}

// At state 0, a change of settings restarts the run. The frozen body stays frozen.
TEST(LiveChanges, AFrozenBodyStaysSoAtTheStart) {
  const Scene scene = live_box(60);
  LiveWorld live(scene, on_cpu());
  live.freeze(7);
  live.freeze(2);
  change_settings(live, [](Settings& s) { s.material.restitution = 0.5; });
  change_settings(live, [](Settings& s) { s.generator.count = 50; });
  EXPECT_THAT(live.world().validation().frozen(), testing::ElementsAre(2, 7));
  for (int k = 0; k < 6; ++k) live.step(false);
  EXPECT_EQ(live.world().bodies().position[7], live.world().initial().position[7]);
  EXPECT_EQ(replayed_hash(live, scene), live.state_hash());
}

TEST(LiveChanges, WhatGuardsFreezeIsAChange) {
  Scene scene = live_box(60);
  scene.physics.guards = ValidationSettings{.on_failure = OnFailure::freeze, .speed = 25};
  scene.physics.effects = Effects{.gravity = true, .guards = true};
  LiveWorld live(scene, on_cpu());
  for (int k = 0; k < 200 && live.world().validation().frozen().empty(); ++k) live.step(false);
  ASSERT_FALSE(live.world().validation().frozen().empty());
  ASSERT_FALSE(live.changes().empty());
  EXPECT_EQ(live.changes()[0].step, live.world().steps() - 1) << "in the state before the step that failed";
  for (int k = 0; k < 5; ++k) live.step(false);
  // The replay agrees also with guards disabled.
  disable_guards(scene.physics);
  EXPECT_EQ(replayed_hash(live, scene), live.state_hash());
}

TEST(LiveChanges, SettingsOfOneStateAreOneChange) {
  const Scene scene = live_box(80);
  LiveWorld live(scene, on_cpu()), untouched(scene, on_cpu());
  for (LiveWorld* one : {&live, &untouched})
    for (int k = 0; k < 5; ++k) one->step(false);
  for (const double restitution : {0.7, 0.6, 0.5, 0.4})
    change_settings(live, [&](Settings& s) { s.material.restitution = restitution; });
  for (const int bodies : {70, 10, 90})
    change_settings(live, [&](Settings& s) { s.generator.count = bodies; });
  change_settings(live, [](Settings& s) { s.run.shape = {3, 64}; });
  change_settings(live, [](Settings& s) { s.physics.precision = Precision::f64; });
  change_settings(live, [](Settings& s) { s.physics.precision = Precision::f32; });
  ASSERT_EQ(live.changes().size(), 1u);
  const Change& one = live.changes()[0];
  EXPECT_EQ(one.settings.get<&Material::restitution>(), 0.4);
  EXPECT_EQ(one.settings.get<&BoxCollider::count>(), 90);
  EXPECT_EQ(one.settings.get<&LaunchShape::blocks>(), 3);
  EXPECT_FALSE(one.settings.get<&Physics::precision>()) << "as it was";
  EXPECT_EQ(live.world().bodies().position[50], untouched.world().bodies().position[50])
      << "it was there at the first value and at the last";
  for (int k = 0; k < 3; ++k) live.step(false);
  change_settings(live, [](Settings& s) { s.material.restitution = 0.3; });
  EXPECT_EQ(live.changes().size(), 2u) << "of another state";
  live.step(false);
  EXPECT_EQ(replayed_hash(live, scene), live.state_hash());
}

TEST(LiveChanges, SettingsThatComeBackAreNoChange) {
  const Scene scene = live_box(80);
  LiveWorld live(scene, on_cpu()), untouched(scene, on_cpu());
  for (LiveWorld* one : {&live, &untouched})
    for (int k = 0; k < 5; ++k) one->step(false);
  change_settings(live, [](Settings& s) { s.generator.count = 20; });
  change_settings(live, [](Settings& s) { s.physics.precision = Precision::f64; });
  change_settings(live, [](Settings& s) { s.physics.solver = Solver::impulse; });
  EXPECT_TRUE(live.edited());
  change_settings(live, [](Settings& s) { s.physics.precision = Precision::f32; });
  change_settings(live, [&](Settings& s) { s.physics.solver = untouched.settings().physics.solver; });
  change_settings(live, [](Settings& s) { s.generator.count = 80; });
  EXPECT_TRUE(live.changes().empty());
  EXPECT_FALSE(live.edited());
  EXPECT_EQ(live.settings(), untouched.settings());
  for (LiveWorld* one : {&live, &untouched})
    for (int k = 0; k < 5; ++k) one->step(false);
  EXPECT_EQ(live.state_hash(), untouched.state_hash());
}

TEST(LiveChanges, ASliderThatIsHeldIsOneChangeOfHowItRuns) {
  LiveWorld live(live_box(80), on_cpu());
  Settings request = live.settings();
  for (int k = 1; k <= 5; ++k) {
    live.step(false);
    request.run.shape.blocks = k;
    live.apply(request, nullptr, k > 1);
  }
  ASSERT_EQ(live.changes().size(), 1u);
  EXPECT_EQ(live.changes()[0].settings.get<&LaunchShape::blocks>(), 5);
  EXPECT_EQ(live.changes()[0].step, 5);
  live.step(false);
  request.run.shape.blocks = 9;
  live.apply(request);
  EXPECT_EQ(live.changes().size(), 2u) << "another hand";
}

TEST(LiveChanges, AfterARestartOnlyTheDifferenceIsLeft) {
  Scene scene = live_box(80);
  scene.bodies.resize(2);
  scene.bodies[1].position = Vector3d(50, 50, 50);
  LiveWorld live(scene, on_cpu());
  const Settings first = live.settings();
  Body ball;
  ball.position = Vector3d(20, 20, 50);
  for (int k = 0; k < 12; ++k) {
    change_settings(live, [&](Settings& s) {
      s.generator.count = 60 + 5 * k;
      s.material.restitution = 0.1 + 0.05 * k;
    });
    if (k == 3 || k == 7 || k == 9) live.apply(add_body(ball));
    if (k == 4) live.apply(remove_body(1));   // a body that the scene lists
    if (k == 8) live.apply(remove_body(30));  // a body of the generator
    if (k == 10) live.apply(remove_body(static_cast<std::int64_t>(live.world().initial().size()) - 2));
    live.step(false);
  }
  EXPECT_GT(live.changes().size(), 12u);
  live.restart();
  ASSERT_EQ(live.changes().size(), 1u);
  EXPECT_EQ(live.changes()[0].step, 0);
  EXPECT_EQ(live.changes()[0].remove.size(), 2u);
  EXPECT_EQ(live.changes()[0].add.size(), 2u);
  EXPECT_EQ(live.changes()[0].settings.get<&BoxCollider::count>(), 115);
  for (int k = 0; k < 4; ++k) live.step(false);
  EXPECT_EQ(replayed_hash(live, scene), live.state_hash());

  // A setting that returns to its start value is no change. Neither is one that is changed back and forth.
  live.restart();
  for (const double restitution : {0.7, 0.6, 0.5})
    change_settings(live, [&](Settings& s) { s.material.restitution = restitution; });
  EXPECT_EQ(live.changes().size(), 1u);
  LiveWorld other(scene, on_cpu());
  other.step(false);
  change_settings(other, [](Settings& s) { s.physics.time_step = 0.01; });
  other.step(false);
  change_settings(other, [&](Settings& s) { s.physics.time_step = first.physics.time_step; });
  other.step(false);
  EXPECT_EQ(other.changes().size(), 2u);
  other.restart();
  EXPECT_TRUE(other.changes().empty());
}

TEST(LiveChanges, ARunThatComesBackKeepsItsRecord) {
  LiveWorld live(live_box(50), on_cpu());
  live.step(true);
  change_settings(live, [](Settings& s) { s.material.restitution = 0.5; });
  live.step(true);
  const std::string before = live.changes_text();
  const LiveWorld::Record record = live.record();
  const SavedRun left = save_run(live.world());
  live.open(World(live_box(20), on_cpu()));
  EXPECT_TRUE(live.changes().empty());
  live.open(World(left.scene, RunOptions(left.options), &left.state), record);
  EXPECT_TRUE(live.edited());
  EXPECT_EQ(live.changes_text(), before);
  live.step(true);
  EXPECT_EQ(replayed_hash(live, live_box(50)), live.state_hash());
  live.restart();
  ASSERT_EQ(live.changes().size(), 1u);
  EXPECT_EQ(live.changes()[0].settings.get<&Material::restitution>(), 0.5);
}

}  // namespace
}  // namespace collidoscope
