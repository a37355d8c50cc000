// Marked states: after rewind(), a run repeats its steps bit for bit, caches included. Same tests on CPU and
// CUDA.

#include <gtest/gtest.h>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/world.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class MarkedStates : public OnEachExecutor {};
ON_EACH_EXECUTOR(MarkedStates);

struct Trace {
  std::vector<std::uint64_t> hashes;
  std::uint64_t full = 0;
  double time = 0;
  bool operator==(const Trace&) const = default;
};

/// Steps the world and notes the hash of each state.
Trace trace(World& world, int steps) {
  Trace result;
  for (int k = 0; k < steps; ++k) {
    world.step();
    result.hashes.push_back(world.state_hash());
  }
  result.full = full_hash(world.state());
  result.time = world.time();
  return result;
}

#ifdef WITH_SANITIZER
const std::vector<int> steps_before_the_mark{2};
constexpr int steps_after_it = 3;
#else
const std::vector<int> steps_before_the_mark{0, 1, 30};
constexpr int steps_after_it = 12;
#endif

TEST_P(MarkedStates, AreReachedAgainInEveryScene) {
  for (const char* name :
       {"rolling", "sinking", "orbits", "carousel", "wrecking_ball", "marble_run", "bridge", "pile",
        "sleepers", "slope", "spinning_top", "newtons_cradle", "tumbling_mesh", "gas"})
    for (const Precision precision : {Precision::f32, Precision::f64})
      for (const int before : steps_before_the_mark) {
        Scene scene = project_scene(name);
        scene.physics.precision = precision;
        World world(scene, options());
        world.step(before);
        const std::uint64_t marked = full_hash(world.state());
        world.mark();
        const Trace first = trace(world, steps_after_it);
        for (int again = 0; again < 2; ++again) {
          ASSERT_TRUE(world.rewind());
          EXPECT_EQ(world.steps(), before);
          EXPECT_EQ(full_hash(world.state()), marked) << name;
          EXPECT_EQ(trace(world, steps_after_it), first) << name << ", state " << before;
        }
      }
}

TEST_P(MarkedStates, AreReachedAgainWithEverySolver) {
  for (const Solver solver : {Solver::impulse, Solver::soft_step, Solver::jacobi_split})
    for (unsigned seed = 0; seed < 20; ++seed) {
      Scene scene = random_scene(seed);
      scene.physics.solver = solver;
      World world(scene, options());
      world.step(5);
      world.mark();
      const Trace first = trace(world, 5);
      ASSERT_TRUE(world.rewind());
      EXPECT_EQ(trace(world, 5), first) << seed;
    }
}

/// Lists that grow after the mark move to other memory.
TEST_P(MarkedStates, OutliveTheGrowthOfLists) {
  Scene scene = box_collider(2000);
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = 0.3;
  RunOptions small = options();
  small.initial_pair_capacity = 8;
  World world(scene, small);
  world.mark();
  const std::int64_t capacity = world.info().allocated_bytes;
  const Trace first = trace(world, 40);
  EXPECT_GT(world.info().allocated_bytes, capacity);
  ASSERT_TRUE(world.rewind());
  EXPECT_EQ(trace(world, 40), first);
}

TEST_P(MarkedStates, AreLostWhenBodiesFreeze) {
  World world(project_scene("slope"), options());
  EXPECT_FALSE(world.rewind()) << "there is no mark yet";
  world.step(3);
  world.mark();
  RunState frozen = world.state();
  frozen.frozen = {0};
  world.restore(frozen);
  const std::uint64_t hash = full_hash(world.state());
  EXPECT_FALSE(world.rewind());
  EXPECT_EQ(full_hash(world.state()), hash);
}

}  // namespace
}  // namespace collidoscope
