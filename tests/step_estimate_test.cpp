// Tests the estimate of a step's pairs, contacts and bytes against a real step.

#include "sim_cuda/run/step_estimate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "sim_cuda/core/error.h"
#include "sim_cuda/run/sampled_pairs.h"
#include "sim_cuda/scene/joint_substeps.h"
#include "tests/executors.h"
#include "tests/random.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

/// The ratio of the larger to the smaller value.
double factor(double a, double b) { return std::max(a, b) / std::max(std::min(a, b), 1e-300); }

StepEstimate estimate_of(const Scene& scene, const RunOptions& options) {
  const InitialBodies initial = initial_bodies(scene);
  Executor executor(options);
  const Effects effects = scene.physics.effects.value_or(required_effects(scene, initial));
  const BodyIdMap ids;
  return estimate_step(
      executor, {options.broad_phase, scene, initial, effects, substeps_of(scene, initial), nullptr, ids, {}},
      true);
}

class StepEstimates : public OnEachExecutor {
 protected:
  void expect_right(const Scene& scene) {
    RunOptions tight = options();
    tight.initial_pair_capacity = 1;
    const StepEstimate expected = estimate_of(scene, tight);
    World world(scene, tight);
    constexpr std::int64_t many =
        20'000;  // larger scenes: measured at rest, where the counts are close to those of a step
    if (expected.bodies <= many) world.step();
    const StepStats found = world.measure();
    EXPECT_EQ(expected.bodies, found.bodies);
    EXPECT_LT(factor(expected.pairs, static_cast<double>(found.pairs)), 1.5)
        << expected.pairs << " for " << found.pairs;
    EXPECT_LT(factor(expected.contacts, static_cast<double>(found.speculative)), 1.5)
        << expected.contacts << " for " << found.speculative;
    // Lists that overflowed have a capacity of 1.5 times the required one.
    const double bytes = static_cast<double>(world.info().allocated_bytes);
    EXPECT_LT(static_cast<double>(expected.bytes), 1.5 * bytes);
    EXPECT_GT(static_cast<double>(expected.bytes), bytes / 1.5 / 1.5);
  }
};
ON_EACH_EXECUTOR(StepEstimates);

Scene generated(std::int64_t bodies, Variant variant, Solver solver = Solver::soft_step) {
  Scene scene = box_collider(bodies, variant);
  scene.physics.solver = solver;
  return scene;
}

TEST_P(StepEstimates, AreRightForThePaper) {
  for (const Solver solver : {Solver::soft_step, Solver::impulse, Solver::jacobi_split})
    expect_right(generated(5000, Variant::paper, solver));
  expect_right(generated(50'000, Variant::paper));
}

TEST_P(StepEstimates, AreRightForBoxesThatGrow) { expect_right(generated(200'000, Variant::scaled)); }

TEST_P(StepEstimates, AreRightForFastBodiesInDouble) {
  Scene scene = generated(20'000, Variant::scaled);
  scene.generators[0].speed_max = 60;
  scene.physics.precision = Precision::f64;
  scene.materials[0].friction = 0.5;
  expect_right(scene);
}

/// Small spheres in a corner beside large ones.
TEST_P(StepEstimates, AreRightForACrowdedCorner) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  Uniform uniform{Random(3)};
  for (int k = 0; k < 12'000; ++k)
    scene.bodies.push_back(sphere(0.01, Vector3d(uniform(0, 0.2), uniform(0, 0.2), uniform(0, 0.2))));
  for (int k = 0; k < 200; ++k) scene.bodies.push_back(sphere(2, Vector3d(50, 50, 50) + uniform.vector(40)));
  expect_right(scene);
}

TEST_P(StepEstimates, RefuseWithFiguresAndAreOverruled) {
  const Scene scene = generated(20'000, Variant::paper);
  RunOptions scarce = options();
  scarce.memory_limit = 40'000'000;
  try {
    World world(scene, scarce);
    FAIL() << "there is no room";
  } catch (const TooLarge& error) {
    EXPECT_THAT(error.plain(), HasSubstr("available: 40.0 MB, the memory limit; use fewer bodies, or "));
    EXPECT_THAT(error.plain(), testing::Not(HasSubstr("--")));
    const std::string line = error.what();
    for (const char* part : {"20,000 bodies", " pairs", " contacts", " bytes", "40000000 bytes (40.0 MB)",
                             "--variant scaled", "--memory-limit"})
      EXPECT_THAT(line, HasSubstr(part));
  }
  scarce.allow_large = true;
  World world(scene, scarce);
  EXPECT_THROW(world.step(), MachineError) << "the lists themselves do not fit";
  EXPECT_EQ(world.steps(), 0);
}

TEST_P(StepEstimates, CountWhatComparingAllBodiesTakes) {
  Scene scene = read_scene(project_file("assets/scenes/box_collider.json").string());
  scene.generators[0].count = 40000;
  scene.generators[0].variant = Variant::scaled;
  RunOptions all = options();
  const double tree = estimate_of(scene, all).seconds;
  all.broad_phase = "brute_force";
  const double brute = estimate_of(scene, all).seconds;
  EXPECT_GT(brute, 5 * tree);
}

TEST_P(StepEstimates, NeverMindScenesOfTheProject) {
  std::vector<std::string> lines;
  set_slow_step_callback([&](const std::string& line) { lines.push_back(line); });
  namespace fs = std::filesystem;
  int scenes = 0;
  for (const char* folder : {"assets/scenes", "assets/scenes/analytic", "assets/scenes/hard"})
    for (const fs::directory_entry& entry : fs::directory_iterator(project_file(folder))) {
      const fs::path file = entry.path();
      if (file.extension() != ".json" || file.stem().has_extension()) continue;
      if (file.stem() == "bodies_16777217") continue;  // for GPUs only
      Scene scene;
      try {
        scene = read_scene(file.string());
        for (BoxCollider& generator : scene.generators)
          if (generator.variant == Variant::settled) generator.variant = Variant::scaled;
        World world(scene, options());
      } catch (const InputError&) {
        continue;  // a hard case whose scene must be refused
      }
      ++scenes;
      const StepEstimate expected = estimate_of(scene, options());
      EXPECT_LT(expected.seconds, 2) << file;
      EXPECT_LT(expected.bytes, 1'000'000'000) << file;
    }
  set_slow_step_callback(nullptr);
  EXPECT_GT(scenes, 60);
  EXPECT_TRUE(lines.empty()) << lines.front();
}

/// The figures do not depend on the number of threads. With all bodies in the sample, all pairs are counted.
TEST(SampledPairs, AreExactOfAll) {
  const InitialBodies bodies = initial_bodies(box_collider(3000));
  const MovingSpheres spheres{bodies.position, bodies.radius, bodies.velocity};
  ThreadTeam one(1), three(3);
  const SampledPairs all = sample_pairs(one, spheres, 5000), same = sample_pairs(three, spheres, 5000);
  EXPECT_EQ(all.pairs, same.pairs);
  EXPECT_EQ(all.contacts, same.contacts);
  World world(box_collider(3000), on_cpu());
  const StepStats stats = world.measure();
  EXPECT_EQ(all.pairs, static_cast<double>(stats.pairs));
  EXPECT_EQ(all.contacts, static_cast<double>(stats.speculative));
  EXPECT_EQ(sample_pairs(one, spheres, 100).pairs, sample_pairs(three, spheres, 100).pairs);
}

}  // namespace
}  // namespace collidoscope
