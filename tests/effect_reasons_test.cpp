// Tests the reasons why an effect is required, against required_effects().

#include "sim_cuda/scene/effect_reasons.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim_cuda/scene/names.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

EffectReason reason_in(const Scene& scene, bool Effects::*flag) {
  return effect_reason(scene, initial_bodies(scene), flag);
}

TEST(EffectReasons, SayWhatIsCalledFor) {
  std::vector<Scene> scenes{empty_space(), box_collider(5)};
  for (const char* name : {"box_collider", "rolling", "rolling_out", "sinking", "orbits", "pendulum_wave",
                           "pile", "carousel", "marble_run", "tumbling_mesh"})
    scenes.push_back(project_scene(name));
  scenes.push_back(empty_space());
  scenes.back().bodies = {sphere(1, Vector3d(0, 0, 0))};
  scenes.back().bodies[0].angular_velocity = Vector3d(0, 0, 1);
  scenes.push_back(empty_space());
  scenes.back().physics.solver = Solver::soft_step;
  scenes.back().physics.sleep = Sleep{};
  for (const Scene& scene : scenes) {
    const Effects called = required_effects(scene, initial_bodies(scene));
    for (const EffectName& effect : effect_names) {
      const EffectReason reason = reason_in(scene, effect.flag);
      EXPECT_EQ(reason.required, called.*effect.flag) << scene.name << ": " << effect.name;
      EXPECT_FALSE(reason.why.empty());
      EXPECT_LT(reason.why.size(), 60u) << "a few words";
    }
  }
}

TEST(EffectReasons, InWords) {
  Scene scene = box_collider(3);
  scene.physics.solver = Solver::soft_step;
  EXPECT_EQ(reason_in(scene, &Effects::gravity).why, "gravity is 9.81 m/s²");
  EXPECT_EQ(reason_in(scene, &Effects::drag).why, "no medium");
  EXPECT_EQ(reason_in(scene, &Effects::friction).why, "0 in all materials");
  EXPECT_EQ(reason_in(scene, &Effects::friction).cannot, "");
  scene.materials[0].rolling_resistance = 0.1;
  EXPECT_EQ(reason_in(scene, &Effects::friction).why, "required by rolling resistance");
  EXPECT_EQ(reason_in(scene, &Effects::rotation).why, "friction applies torques");
  EXPECT_EQ(reason_in(scene, &Effects::rolling_resistance).why,
            "the material \"default\" has rolling resistance 0.1");
  scene.physics.solver = Solver::impulse;
  scene.physics.effects = Effects{.gravity = true};
  EXPECT_EQ(reason_in(scene, &Effects::friction).cannot, "not supported by impulse");
  EXPECT_EQ(reason_in(scene, &Effects::gravity).cannot, "");
}

}  // namespace
}  // namespace collidoscope
