// Tests World: continued runs, changes of N and of the launch shape, inspection against hand-computed values,
// and memory limits.
#include "sim_cuda/world.h"

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/host_memory.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Worlds : public OnEachExecutor {};
ON_EACH_EXECUTOR(Worlds);

TEST_P(Worlds, AnAdoptedRunGoesOnBitForBit) {
  Scene scene = box_collider(600);
  scene.materials[0].restitution = 0.5;
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    scene.physics.precision = precision;
    World whole(scene, options()), first(scene, options());
    whole.step(60);
    first.step(23);
    RunOptions other = options();
    other.executor = ExecutorKind::cpu;
    other.broad_phase = "brute_force";
    other.shape = {2, 8};
    World second(scene, other);
    second.restore(first);
    second.step(37);
    EXPECT_EQ(second.steps(), 60);
    EXPECT_EQ(second.state_hash(), whole.state_hash());
    EXPECT_EQ(second.measure().wall_impulse, whole.measure().wall_impulse);
  }
}

TEST_P(Worlds, AGrownOneKeepsItsSurvivorsAndSpawnsTheRest) {
  World small(box_collider(100), options()), large(box_collider(250), options());
  small.step(10);
  const BodyStates before = small.bodies(), fresh = large.bodies();
  large.restore(small);
  const BodyStates after = large.bodies();
  for (std::size_t i = 0; i < 250; ++i)
    EXPECT_EQ(after.position[i], i < 100 ? before.position[i] : fresh.position[i]);
  World shrunk(box_collider(40), options());
  shrunk.restore(large);
  EXPECT_EQ(shrunk.bodies().position[39], before.position[39]);
  shrunk.step();
  EXPECT_EQ(shrunk.measure().bodies, 40);
}

TEST_P(Worlds, ANewLaunchShapeActsAtTheNextStep) {
  World world(box_collider(500), options()), plain(box_collider(500), options());
  for (const LaunchShape shape : {LaunchShape{1, 1}, {4, 32}, {0, 0}, {2, 1024}}) {
    world.set_launch_shape(shape);
    EXPECT_EQ(world.launch_shape(), shape);
    world.step(3);
  }
  EXPECT_THROW(world.set_launch_shape({1, 1025}), InputError);
  EXPECT_EQ(world.launch_shape(), (LaunchShape{2, 1024}));
  plain.step(12);
  EXPECT_EQ(world.state_hash(), plain.state_hash());
}

TEST_P(Worlds, InspectTellsAllOfABody) {
  Scene scene = empty_space();
  scene.bodies = {sphere(1, Vector3d(1, -2, 3), Vector3d(0.1, 0.2, 0.3))};
  scene.bodies[0].mass = 2;
  scene.bodies[0].inertia = Vector3d(1, 2, 2.5);
  scene.bodies[0].angular_velocity = Vector3d(0.5, 3, -1);
  World top(scene, options());
  top.step(7);
  const BodyReport report = top.inspect(0);
  const StepStats stats = top.measure();
  // One body: its momenta are those of the world, and L = I w.
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(report.P[k], stats.momentum[k], 1e-6 * (1 + std::abs(stats.momentum[k])));
    EXPECT_NEAR((report.X.cross(report.P) + report.L)[k], stats.angular_momentum[k], 1e-6 * report.L.norm());
  }
  EXPECT_LT((report.inverse_inertia * report.L - report.w).norm(), 1e-5 * report.w.norm());

  World box(box_collider(1500), options());
  box.detect();
  const auto pairs = box.pairs();
  const BodyStates states = box.bodies();
  const TreeLevels tree = box.tree().levels();
  for (const std::uint32_t id : {0u, 3u, 700u, 1499u}) {
    const BodyReport body = box.inspect(id);
    std::vector<std::uint32_t> expected;
    for (const auto& [a, b] : pairs) {
      if (a != id && b != id) continue;
      const double reach = box.initial().radius[a] + box.initial().radius[b];
      if ((states.position[a] - states.position[b]).norm() <= reach) expected.push_back(a == id ? b : a);
    }
    std::sort(expected.begin(), expected.end());
    ASSERT_EQ(body.contacts.size(), expected.size());
    EXPECT_EQ(body.contact_count, static_cast<std::int64_t>(expected.size()));
    for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_EQ(body.contacts[k].other, expected[k]);
    ASSERT_GE(body.path.size(), 2u);
    ASSERT_LE(body.path.size(), tree.levels.size()) << "leaves need not be on the last level";
    for (std::size_t level = 0; level < body.path.size(); ++level)
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(body.path[level].min[axis], states.position[id][axis]);
        EXPECT_GE(body.path[level].max[axis], states.position[id][axis]);
      }
    EXPECT_EQ(body.path.back().min[0], tree.levels.front()[0].min[0]) << "ends at the root";
  }
  EXPECT_THROW(box.inspect(1500), std::out_of_range);
}

TEST_P(Worlds, StageTimesNameThePipelineInOrder) {
  using Names = std::vector<std::string>;
  const Names detection{"bounds", "keys", "sort", "build", "pairs", "contacts", "colour"};
  const Names impulse{"solve", "integrate", "walls", "move"};
  const Names soft_step{"prepare", "bounce", "integrate", "forces", "solve", "move", "relax", "keep"};
  for (const Solver solver : {Solver::impulse, Solver::soft_step}) {
    Scene scene = box_collider(300);
    scene.physics.solver = solver;
    World world(scene, options());
    world.step(8);
    const RunTimes times = world.times();
    Names names, expected = detection;
    for (const StageTime& stage : times.stages) {
      names.push_back(stage.name);
      EXPECT_GE(stage.launches, 1) << stage.name;
      EXPECT_GT(stage.median_ms, 0) << stage.name;
    }
    const Names& of_solver = solver == Solver::impulse ? impulse : soft_step;
    expected.insert(expected.end(), of_solver.begin(), of_solver.end());
    EXPECT_EQ(names, expected);
    EXPECT_EQ(times.steps_timed, 4);
    EXPECT_GT(times.step_median_ms, 0);
  }
}

TEST_P(Worlds, StagesSayWhatTheyWereLaunchedAs) {
  RunOptions o = options();
  o.cpu_threads = 2;
  const auto launch_of = [](World& world, const std::string& name) {
    for (const StageTime& stage : world.times().stages)
      if (stage.name == name) return stage.launch;
    return StageLaunch{};
  };
  World world(box_collider(2000), o);
  EXPECT_EQ(launch_of(world, "bounds").threads, 0) << "nothing was launched yet";
  world.step(2);
  const StageLaunch bounds = launch_of(world, "bounds");
  EXPECT_EQ(bounds.items, 2000);
  EXPECT_EQ(launch_of(world, "move").items, 2000) << "its other kernel has one item";
  if (GetParam() == ExecutorKind::cuda) {
    EXPECT_EQ(bounds.threads, 128);
    EXPECT_EQ(bounds.blocks, 16);
    EXPECT_EQ(bounds.chunk, 0);
    EXPECT_EQ(bounds.limit, LaunchLimit::items);
    EXPECT_GT(bounds.registers, 0);
    EXPECT_LE(bounds.registers, 64) << "or no block of 1,024 threads could be launched";
    EXPECT_GT(bounds.multiprocessors, 0);
    EXPECT_GT(bounds.occupancy, 0);
    EXPECT_LE(bounds.occupancy, 1);
  } else {
    EXPECT_EQ(bounds.blocks, 4);
    EXPECT_EQ(bounds.chunk, 512);
    EXPECT_EQ(bounds.threads, 2);
    EXPECT_EQ(bounds.limit, LaunchLimit::threads);
    EXPECT_EQ(bounds.multiprocessors, 0);
  }
  world.set_launch_shape({3, 64});
  world.step(2);
  const StageLaunch asked = launch_of(world, "bounds");
  if (GetParam() == ExecutorKind::cuda) {
    EXPECT_EQ(asked.blocks, 3);
    EXPECT_EQ(asked.threads, 64);
    EXPECT_EQ(asked.limit, LaunchLimit::shape);
  } else {
    EXPECT_EQ(asked.blocks, 192) << "lanes";
    EXPECT_EQ(asked.chunk, 11);
    EXPECT_EQ(asked.threads, 2);
  }
}

TEST_P(Worlds, SayHowManyBytesTheyLackAndLiveOn) {
  const Scene scene = box_collider(3000);
  World roomy(scene, options());
  roomy.step(20);
  ASSERT_GT(roomy.measure().pairs, 3000);

  RunOptions o = options();
  o.initial_pair_capacity = 16;
  const std::int64_t without_pairs = World(scene, o).info().allocated_bytes;
  o.memory_limit = without_pairs + 20'000;
  World tight(scene, o);
  const std::uint64_t before = tight.state_hash();
  for (int attempt = 0; attempt < 2; ++attempt) {
    try {
      tight.step(20);
      FAIL() << "there was no room for " << roomy.measure().pairs << " pairs";
    } catch (const MachineError& error) {
      const std::string line = error.what();
      EXPECT_NE(line.find(" pairs, which need at least "), std::string::npos) << line;
      EXPECT_NE(line.find("provides " + std::to_string(o.memory_limit)), std::string::npos) << line;
    }
    EXPECT_EQ(tight.state_hash(), before);
    EXPECT_LE(tight.info().allocated_bytes, o.memory_limit);
  }

  // A limit of exactly the required memory suffices, without spare capacity.
  o.memory_limit = 0;
  World grown(scene, o);
  grown.step(20);
  o.memory_limit = grown.info().allocated_bytes;
  std::int64_t least = without_pairs, most = o.memory_limit;
  while (most - least > 1000) {
    o.memory_limit = (least + most) / 2;
    try {
      World world(scene, o);
      world.step(20);
      EXPECT_EQ(world.state_hash(), roomy.state_hash());
      EXPECT_LE(world.info().allocated_bytes, o.memory_limit);
      most = o.memory_limit;
    } catch (const MachineError&) {
      least = o.memory_limit;
    }
  }
  EXPECT_LT(most, grown.info().allocated_bytes) << "growing by half was not given up where it does not fit";
}

TEST(HostMemory, IsThereAndNotEndless) {
  EXPECT_GT(free_host_bytes(), std::int64_t{1} << 24);
  EXPECT_LT(free_host_bytes(), std::int64_t{1} << 50);
}

}  // namespace
}  // namespace collidoscope
