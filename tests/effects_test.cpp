// Which effects a build holds, and how a stage is chosen by them.

#include "sim_cuda/scene/effects.h"

#include <gtest/gtest.h>

#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

TEST(Effects, ABuildLeavesOutWhatItIsToldTo) {
  static_assert(is_built("friction", ""));
  static_assert(!is_built("friction", "friction"));
  static_assert(!is_built("friction", "drag friction joints"));
  static_assert(is_built("friction", "frictions no_friction"));
  static_assert(!is_built("friction", "frictions friction"));
  for (const EffectName& effect : effect_names)
    EXPECT_EQ(built_effects.*effect.flag, is_built(effect.name)) << effect.name;
}

TEST(Effects, ChooseTheTemplate) {
  Effects effects;
  const auto chosen = [&] {
    bool on = false;
    with_effect<&Effects::drag>(effects, [&]<bool drag>() { on = drag; });
    return on;
  };
  EXPECT_FALSE(chosen());
  EXPECT_FALSE(chosen());
  effects.drag = true;
  EXPECT_EQ(chosen(), built_effects.drag);
}

}  // namespace
}  // namespace collidoscope
