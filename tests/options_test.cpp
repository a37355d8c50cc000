// Tests command-line options: each flag belongs to a command, overrides reach the scene, and faults name the
// flag that caused them.
#include "headless/cli/options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "headless/cli/flag_value.h"
#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

Options read_options(const std::vector<std::pair<const char*, const char*>>& given) {
  Options options;
  std::vector<std::string> faults;
  for (const auto& [name, text] : given) {
    FlagValue value(name, text, faults);
    std::ranges::find(flags(), name, &Flag::name)->read(value, options);
  }
  EXPECT_TRUE(faults.empty()) << faults[0];
  return options;
}

Scene generated() {
  Scene scene;
  scene.box = Box{};
  scene.generators.emplace_back();
  return scene;
}

TEST(Options, EveryFlagIsReadOnceAndBelongsToACommand) {
  std::set<std::string_view> names;
  for (const Flag& flag : flags()) {
    EXPECT_TRUE(names.insert(flag.name).second) << flag.name;
    EXPECT_NE(flag.commands, 0u) << flag.name;
    EXPECT_TRUE(std::string_view(flag.name).starts_with("--"));
  }
}

TEST(Options, NothingGivenChangesNothing) {
  Scene scene = generated();
  scene.physics.time_step = TimeStep::per_second(60);
  apply(Overrides{}, "x.json", scene);
  EXPECT_EQ(scene.generators[0].count, 2000);
  EXPECT_EQ(scene.physics.time_step.steps_per_second(), 60);
}

TEST(Options, OverridesReachTheScene) {
  const Options options = read_options({{"--bodies", "17"},
                                        {"--variant", "scaled"},
                                        {"--spawn", "centres"},
                                        {"--seed", "9"},
                                        {"--gravity", "0,1,2"},
                                        {"--time-step", "0.25"},
                                        {"--substeps", "3"},
                                        {"--iterations", "4"},
                                        {"--integrator", "rk4"},
                                        {"--rotation-update", "lie_group"},
                                        {"--precision", "f64"},
                                        {"--effects", "gravity,rotation"},
                                        {"--restitution-threshold", "0.5"}});
  Scene scene = generated();
  scene.physics.time_step = TimeStep::per_second(30);
  apply(options.overrides, "x.json", scene);
  EXPECT_EQ(scene.generators[0].count, 17);
  EXPECT_EQ(scene.generators[0].variant, Variant::scaled);
  EXPECT_EQ(scene.generators[0].spawn, Spawn::centres);
  EXPECT_EQ(scene.generators[0].seed, 9u);
  EXPECT_EQ(scene.physics.gravity, Vector3d(0, 1, 2));
  EXPECT_EQ(scene.physics.time_step, 0.25);
  EXPECT_FALSE(scene.physics.time_step.steps_per_second());
  EXPECT_EQ(scene.physics.substeps, 3);
  EXPECT_EQ(scene.physics.iterations, 4);
  EXPECT_EQ(scene.physics.integrator, Integrator::rk4);
  EXPECT_EQ(scene.physics.rotation_update, RotationUpdate::lie_group);
  EXPECT_EQ(scene.physics.precision, Precision::f64);
  EXPECT_EQ(scene.physics.effects, (Effects{.gravity = true, .rotation = true}));
  EXPECT_EQ(scene.physics.restitution_threshold, 0.5);
}

TEST(Options, AFractionIsAnExactRate) {
  Scene scene = generated();
  apply(read_options({{"--time-step", "1/120"}}).overrides, "x.json", scene);
  EXPECT_EQ(scene.physics.time_step.steps_per_second(), 120);
  EXPECT_EQ(scene.physics.time_step, 1.0 / 120);
}

TEST(Options, AutoTakesASettingBack) {
  Scene scene = generated();
  scene.physics.effects = Effects{};
  scene.physics.restitution_threshold = 3;
  apply(read_options({{"--effects", "auto"}, {"--restitution-threshold", "auto"}}).overrides, "x.json",
        scene);
  EXPECT_FALSE(scene.physics.effects);
  EXPECT_FALSE(scene.physics.restitution_threshold);

  apply(read_options({{"--effects", "none"}}).overrides, "x.json", scene);
  EXPECT_EQ(scene.physics.effects, Effects{});
}

TEST(Options, LaunchShapesAreCountsOrAuto) {
  EXPECT_EQ(read_options({{"--blocks", "3"}, {"--threads", "37"}}).run.shape, (LaunchShape{3, 37}));
  EXPECT_EQ(read_options({{"--blocks", "auto"}, {"--threads", "auto"}}).run.shape, LaunchShape{});
}

TEST(Options, GeneratorFlagsNeedOneGenerator) {
  Scene none, two = generated();
  two.generators.emplace_back();
  const Overrides overrides = read_options({{"--bodies", "5"}, {"--seed", "5"}}).overrides;
  for (Scene* scene : {&none, &two}) {
    try {
      apply(overrides, "x.json", *scene);
      FAIL();
    } catch (const InputError& error) {
      ASSERT_EQ(error.lines().size(), 2u);
      EXPECT_TRUE(error.lines()[0].starts_with("--bodies: x.json has ")) << error.lines()[0];
      EXPECT_TRUE(error.lines()[1].starts_with("--seed: x.json has ")) << error.lines()[1];
    }
  }
}

TEST(Options, AFaultThatAFlagCausedNamesTheFlag) {
  Scene scene = generated();  // 2000 generated bodies and one listed: too many together
  scene.bodies.emplace_back();
  try {
    apply(read_options({{"--bodies", "134217728"}}).overrides, "x.json", scene);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_TRUE(error.lines()[0].starts_with("--bodies: ")) << error.lines()[0];
  }
}

}  // namespace
}  // namespace collidoscope
