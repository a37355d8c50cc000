// Tests requests that exceed the memory: the message states the bytes, and the existing world continues
// unchanged. RunOptions::memory_limit stands for the memory of the device or host.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/error.h"
#include "tests/executors.h"
#include "tests/scenes.h"
#include "viewer/session/live_world.h"

namespace collidoscope {
namespace {

class OutOfMemoryOn : public OnEachExecutor {};
ON_EACH_EXECUTOR(OutOfMemoryOn);

/// The largest number in the line: the required bytes.
std::int64_t largest_number(const std::string& line) {
  std::int64_t largest = 0;
  const std::regex number("[0-9]+");
  for (std::sregex_iterator at(line.begin(), line.end(), number), end; at != end; ++at)
    largest = std::max<std::int64_t>(largest, std::stoll(at->str()));
  return largest;
}

std::string refusal_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const MachineError& error) {
    return error.what();
  }
  return "none";
}

/// 300 spheres that move towards one point, so that the number of pairs grows.
Scene implosion(Solver solver) {
  Scene scene = empty_space();
  scene.physics.solver = solver;
  scene.physics.attractors.clear();
  Uniform uniform{Random(7)};
  for (int k = 0; k < 300; ++k) {
    const Vector3d place = uniform.vector(60);
    scene.bodies.push_back(sphere(2, place, place * -1.5));
  }
  return scene;
}

TEST_P(OutOfMemoryOn, ARefusedBufferIsNamedWithWhatAllTake) {
  RunOptions scarce = options();
  scarce.memory_limit = 1 << 20;
  Executor executor(scarce);
  Buffer<char> a(executor, "a"), b(executor, "b"), c(executor, "c");
  a.resize_discarding(600'000);
  b.resize_discarding(300'000);
  EXPECT_THAT(
      refusal_of([&] { c.resize_discarding(500'000); }),
      testing::HasSubstr(": allocation of 500000 bytes for 'c' failed, 1400000 bytes in total (largest: 'a' "
                         "600000, 'c' 500000, 'b' 300000): 148576 bytes are free"));
}

/// The message states the total during the construction of a world, not only the failing buffer.
TEST_P(OutOfMemoryOn, AWorldThatDoesNotFitIsRefusedWithATotal) {
  RunOptions scarce = options();
  scarce.memory_limit = 1 << 20;
  const std::string line = refusal_of([&] { World(box_collider(20'000), scarce); });
  EXPECT_THAT(line, testing::HasSubstr(" bytes")) << line;
  EXPECT_GT(largest_number(line), scarce.memory_limit) << line;
}

TEST_P(OutOfMemoryOn, GrowthThatDoesNotFitLeavesTheState) {
  for (const Solver solver : {Solver::impulse, Solver::soft_step, Solver::jacobi_split}) {
    const Scene scene = implosion(solver);
    RunOptions roomy = options();
    roomy.initial_pair_capacity = 16;
    World undisturbed(scene, roomy);
    const std::int64_t at_first = undisturbed.info().allocated_bytes;
    undisturbed.step(25);
    ASSERT_GT(undisturbed.info().allocated_bytes, at_first + 1000);

    RunOptions scarce = roomy;
    scarce.memory_limit = (at_first + undisturbed.info().allocated_bytes) / 2;
    World world(scene, scarce);
    const std::string line = refusal_of([&] { world.step(25); });
    EXPECT_THAT(line, testing::HasSubstr(" pairs")) << line;
    EXPECT_GT(largest_number(line), scarce.memory_limit) << line;
    EXPECT_LE(world.info().allocated_bytes, scarce.memory_limit);
    EXPECT_LT(world.steps(), 25);

    World beside(scene, roomy);
    beside.step(static_cast<int>(world.steps()));
    EXPECT_EQ(world.state_hash(), beside.state_hash()) << "at state " << world.steps();
    EXPECT_THAT(refusal_of([&] { world.step(); }), testing::StartsWith(line.substr(0, line.find(" pairs"))));
    EXPECT_EQ(world.state_hash(), beside.state_hash());
    // With more memory the run continues from the state.
    World roomier(scene, roomy);
    roomier.restore(world);
    roomier.step(25 - static_cast<int>(world.steps()));
    EXPECT_EQ(roomier.state_hash(), undisturbed.state_hash());
  }
}

TEST_P(OutOfMemoryOn, AChangeOfNThatDoesNotFitLeavesTheRun) {
  Scene scene = box_collider(200);
  scene.physics.solver = Solver::soft_step;
  World undisturbed(scene, options());
  undisturbed.step(10);
  RunOptions scarce = options();
  scarce.memory_limit = 2 * undisturbed.info().allocated_bytes;
  World world(scene, scarce);
  world.step(5);
  Change change;
  change.settings.set<&BoxCollider::count>(1'000'000);
  const std::string line = refusal_of([&] { world_after_change(world, change, scarce); });
  EXPECT_THAT(line, testing::HasSubstr(" bytes")) << line;
  EXPECT_GT(largest_number(line), 100'000) << line;
  world.step(5);
  EXPECT_EQ(world.state_hash(), undisturbed.state_hash());
}

/// The same change, made by the slider of N in the window.
TEST_P(OutOfMemoryOn, TheWindowKeepsTheRunThatItHas) {
  Scene scene = box_collider(200);
  scene.physics.solver = Solver::soft_step;
  RunOptions scarce = options();
  scarce.memory_limit = 16 << 20;
  LiveWorld live(scene, scarce);
  LiveWorld undisturbed(scene, scarce);
  for (int k = 0; k < 5; ++k) {
    live.step(true);
    undisturbed.step(true);
  }
  Settings request = live.settings();
  request.generator.count = 5'000'000;
  const std::string line = refusal_of([&] { live.apply(request); });
  EXPECT_THAT(line, testing::HasSubstr(" bytes")) << line;
  for (int k = 0; k < 5; ++k) {
    live.step(true);
    undisturbed.step(true);
  }
  EXPECT_EQ(live.state_hash(), undisturbed.state_hash());
}

}  // namespace
}  // namespace collidoscope
