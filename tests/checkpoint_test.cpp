// Tests that a checkpoint returns to any recorded state of a run, bit for bit.

#include "sim_cuda/run/checkpoint.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "sim_cuda/scene/names.h"
#include "sim_cuda/world.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Checkpoints : public OnEachExecutor {};
ON_EACH_EXECUTOR(Checkpoints);

TEST_P(Checkpoints, ToAnyStateThatWasFollowed) {
  for (const auto& [name, solver, help] : solver_names) {
    Scene scene = box_collider(150);
    scene.generators[0].radius_max = 9;
    scene.physics.solver = solver;
    World world(scene, options());
    Checkpoint checkpoint;
    world.step(5);
    std::vector<std::uint64_t> hashes;
    for (int k = 0; k < 30; ++k) {
      hashes.push_back(world.state_hash());
      checkpoint.save_if_due(world);
      world.step();
    }
    const std::uint64_t last = world.state_hash();
    checkpoint.restore(world, world.steps() - 1);
    EXPECT_EQ(world.steps(), 34);
    EXPECT_EQ(world.state_hash(), hashes[29]) << name;
    checkpoint.save_if_due(world);
    world.step();
    EXPECT_EQ(world.state_hash(), last) << name;
  }
}

TEST_P(Checkpoints, NotToWhatWasNot) {
  World world(box_collider(10), options());
  Checkpoint checkpoint;
  EXPECT_THROW(checkpoint.restore(world, 0), std::logic_error);
  world.step(3);
  checkpoint.save_if_due(world);
  EXPECT_THROW(checkpoint.restore(world, 2), std::logic_error);
  checkpoint.clear();
  EXPECT_THROW(checkpoint.restore(world, 3), std::logic_error);
}

}  // namespace
}  // namespace collidoscope
