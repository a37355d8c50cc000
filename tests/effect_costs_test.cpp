// Tests the measured cost of effects. The measurement must not change the running world.

#include "viewer/session/effect_costs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim_cuda/scene/names.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class CostsOfEffects : public OnEachExecutor {};
ON_EACH_EXECUTOR(CostsOfEffects);

Scene rubbing() {
  Scene scene = box_collider(200);
  scene.box->max = Vector3d(30, 30, 30);
  scene.generators[0].radius_max = 3;
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = 0.5;
  return scene;
}

const EffectView& of(const std::vector<EffectView>& all, bool Effects::*flag) {
  for (const EffectView& view : all)
    if (view.flag == flag) return view;
  throw std::out_of_range("no such effect");
}

TEST_P(CostsOfEffects, AreMeasuredWithoutTouchingTheRun) {
  for (const int start : {10, 11}) {
    World world(rubbing(), options()), alone(rubbing(), options());
    world.step(start);
    alone.step(start + 5);
    EffectCosts costs;
    costs.begin(world);
    EXPECT_FALSE(of(costs.views(world), &Effects::gravity).cost.has_value());
    int slices = 0;
    for (; !costs.done() && slices < 1000; ++slices) costs.advance(world, 0);
    EXPECT_EQ(slices, 3 * EffectCosts::pairs) << "a pair in each: gravity, rotation, friction";
    world.step(5);
    EXPECT_EQ(world.state_hash(), alone.state_hash());

    const std::vector<EffectView> all = costs.views(world);
    ASSERT_EQ(all.size(), effect_names.size());
    for (const EffectView& effect : all) {
      EXPECT_EQ(effect.cost.has_value(), effect.on) << effect.name;
      if (!effect.cost) continue;
      EXPECT_EQ(effect.cost->unavailable_reason, "");
      EXPECT_EQ(effect.cost->ratio.pairs, EffectCosts::pairs);
      EXPECT_EQ(effect.cost->step, start);
      EXPECT_GT(effect.cost->without_ms, 0);
      EXPECT_LE(effect.cost->ms_low(), effect.cost->ms());
      EXPECT_LE(effect.cost->ms(), effect.cost->ms_high());
      EXPECT_TRUE(std::isfinite(effect.cost->ms_high()));
    }
    // With gravity, loads have a factor, a float for each body (solver/energy_guard.h), and chains have two
    // lists of contacts and bodies, and their sizes (solver/chain_contacts.h).
    EXPECT_EQ(of(all, &Effects::gravity).cost->bytes, 4 * 200 + 2 * 4 * (1024 + 200) + 4 * (6 + 1));
    // Friction stores impulses. Switching rotation off also switches friction off, and rotation stores q and
    // w.
    EXPECT_GT(of(all, &Effects::friction).cost->bytes, 0);
    EXPECT_GT(of(all, &Effects::rotation).cost->bytes, of(all, &Effects::friction).cost->bytes);
  }
}

TEST_P(CostsOfEffects, OfOneThatIsOffAreThoseOfSwitchingItOn) {
  Scene scene = rubbing();
  scene.physics.effects = Effects{.gravity = true};
  World world(scene, options());
  EffectCosts costs;
  costs.begin(world);
  while (!costs.done()) costs.advance(world, 1e9);
  const std::vector<EffectView> all = costs.views(world);
  EXPECT_FALSE(of(all, &Effects::friction).on);
  ASSERT_TRUE(of(all, &Effects::friction).cost.has_value());
  scene.physics.effects = Effects{.gravity = true, .rotation = true, .friction = true};
  World with(scene, options());
  EXPECT_EQ(of(all, &Effects::friction).cost->bytes,
            with.info().allocated_bytes - world.info().allocated_bytes);
  EXPECT_FALSE(of(all, &Effects::drag).cost.has_value());
}

TEST(EffectCosts, SayWhatCannotBeMeasured) {
  RunOptions o;
  o.executor = ExecutorKind::cpu;
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.bodies = {sphere(1, Vector3d(0, 0, 0))};
  scene.joints.resize(1);
  scene.joints[0].kind = JointKind::hinge;
  scene.joints[0].a = 0;
  World world(scene, o);
  EffectCosts costs;
  costs.begin(world);
  while (!costs.done()) costs.advance(world, 1e9);
  const std::vector<EffectView> all = costs.views(world);
  EXPECT_THAT(of(all, &Effects::rotation).cost->unavailable_reason,
              testing::HasSubstr("must contain rotation"));
  EXPECT_EQ(of(all, &Effects::joints).cost->unavailable_reason, "");

  scene = rubbing();
  scene.physics.solver = Solver::impulse;
  scene.physics.effects = Effects{};
  World paper(scene, o);
  costs.begin(paper);
  while (!costs.done()) costs.advance(paper, 1e9);
  EXPECT_EQ(of(costs.views(paper), &Effects::friction).cannot, "not supported by impulse");
  EXPECT_FALSE(of(costs.views(paper), &Effects::friction).cost.has_value());
}

TEST(EffectCosts, SwitchesTakeAlongWhatTheyMust) {
  const Effects none;
  EXPECT_EQ(with_switched(none, &Effects::rolling_resistance, true),
            (Effects{.rotation = true, .friction = true, .rolling_resistance = true}));
  EXPECT_EQ(with_switched({.gravity = true, .rotation = true, .friction = true, .rolling_resistance = true},
                          &Effects::rotation, false),
            Effects{.gravity = true});
  EXPECT_EQ(with_switched({.rotation = true, .friction = true}, &Effects::friction, false),
            Effects{.rotation = true});
}

}  // namespace
}  // namespace collidoscope
