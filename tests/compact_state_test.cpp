// Tests that a compact state has all parts of a state with the same bits, and takes less memory.

#include "sim_cuda/recording/compact_state.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "sim_cuda/snapshot/snapshot.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using Limits = std::numeric_limits<double>;

std::string bytes_of(World& world, const RunState& state) {
  Snapshot snapshot = snapshot_of(world);
  snapshot.state = state;
  std::string bytes;
  write_snapshot(snapshot, [&](std::string_view more) { bytes += more; });
  return bytes;
}

Scene pile(Precision precision) {
  Scene scene = box_collider(400, Variant::scaled);
  scene.physics.precision = precision;
  scene.physics.solver = Solver::soft_step;
  scene.physics.sleep = Sleep{};
  scene.materials[0].friction = 0.5;
  scene.materials[0].rolling_resistance = 0.01;
  return scene;
}

TEST(CompactState, HasTheSameBits) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world(pile(precision), on_cpu(2));
    for (int k = 0; k < 3; ++k) {
      const RunState state = world.state();
      const CompactState compact(state);
      EXPECT_EQ(compact.steps(), world.steps());
      EXPECT_EQ(bytes_of(world, compact.state()), bytes_of(world, state));
      world.step(20);
    }
    const RunState state = world.state();
    ASSERT_GT(state.warm_start.rolling.size(), 50u) << "the scene has contacts";
    const auto plain = static_cast<std::int64_t>(bytes_of(world, state).size());
    EXPECT_LT(CompactState(state).bytes(), plain * (precision == Precision::f32 ? 4 : 7) / 10);
  }
}

TEST(CompactState, HasTheSameBitsOfEveryKindOfNumber) {
  const double special[] = {0,
                            -0.0,
                            1,
                            0.1,
                            static_cast<double>(0.1f),
                            Limits::infinity(),
                            -Limits::infinity(),
                            Limits::quiet_NaN(),
                            -Limits::quiet_NaN(),
                            std::bit_cast<double>(0x7ff4000000000001u),  // a signalling NaN
                            Limits::denorm_min(),
                            Limits::max(),
                            static_cast<double>(std::numeric_limits<float>::denorm_min())};
  for (const double one : special)
    for (const double other : special) {
      RunState state;
      state.time = one;
      state.frozen = {3, 8};
      state.warm_start.loop_energies = {{one, 2}, {other, 0}, {1, one}};
      state.warm_start.walls = {{}, {one, other, 0}};
      state.warm_start.joints = {{1, 2, 3, {one, other, 0, 1, 2, 3, 4}}};
      const RunState copy = CompactState(state).state();
      const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
      EXPECT_EQ(bits(copy.time), bits(one));
      EXPECT_EQ(copy.frozen, state.frozen);
      ASSERT_EQ(copy.warm_start.loop_energies.size(), 3u);
      EXPECT_EQ(bits(copy.warm_start.loop_energies[0][0]), bits(one));
      EXPECT_EQ(bits(copy.warm_start.loop_energies[1][0]), bits(other));
      EXPECT_EQ(bits(copy.warm_start.loop_energies[2][1]), bits(one));
      ASSERT_EQ(copy.warm_start.walls.size(), 2u);
      ASSERT_EQ(copy.warm_start.walls[1].size(), 3u);
      EXPECT_EQ(bits(copy.warm_start.walls[1][0]), bits(one));
      EXPECT_EQ(bits(copy.warm_start.walls[1][1]), bits(other));
      ASSERT_EQ(copy.warm_start.joints.size(), 1u);
      EXPECT_EQ(copy.warm_start.joints[0].b, 2u);
      EXPECT_EQ(copy.warm_start.joints[0].kind, 3u);
      EXPECT_EQ(bits(copy.warm_start.joints[0].impulse[1]), bits(other));
      EXPECT_EQ(copy.warm_start.joints[0].impulse[6], 4);
    }
}

}  // namespace
}  // namespace collidoscope
