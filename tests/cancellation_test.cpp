// Tests cancellation at every poll within a step, a detection or a construction. A cancelled call must leave
// the world as it was, and later steps must match an uninterrupted run.

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/scene/broad_phase_methods.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include "sim_cuda/scene/names.h"
#include "sim_cuda/snapshot/presimulation.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "tests/executors.h"
#include "tests/random.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

/// Counts the polls on this thread and requests cancellation at one of them.
class Looks {
 public:
  Looks() {
    cancellation.set_poll(
        [this] {
          if (++seen_ == wanted_) cancellation.request();
        },
        {});
  }
  /// Returns whether the work was cancelled at its k-th poll.
  template <class Work>
  bool cancel_at(int k, const Work& work) {
    seen_ = 0;
    wanted_ = k;
    bool cancelled = false;
    try {
      work();
    } catch (const Cancelled&) {
      cancelled = true;
    }
    wanted_ = 0;
    cancellation.clear();
    return cancelled;
  }
  int seen() const { return seen_; }

  Cancellation cancellation;

 private:
  int seen_ = 0, wanted_ = 0;
};

/// The complete state of the run, as snapshot bytes.
std::string state_of(World& world) {
  std::string bytes;
  write_snapshot(snapshot_of(world), [&](std::string_view more) { bytes += more; });
  return bytes;
}

/// Spheres that fall on each other in a box, with all effects of the solver.
Scene busy_scene(Solver solver, Precision precision) {
  Scene scene;
  scene.name = "busy";
  scene.box = Box{Vector3d(-6, -6, 0), Vector3d(6, 6, 12)};
  Physics& physics = scene.physics;
  physics.solver = solver;
  physics.precision = precision;
  physics.substeps = 3;
  physics.iterations = 2;
  physics.drag.viscosity = 0.01;
  physics.guards = ValidationSettings{};
  Uniform uniform{Random(11)};
  for (int k = 0; k < 90; ++k)
    scene.bodies.push_back(
        sphere(uniform(0.4, 0.9), Vector3d(0, 0, 6) + uniform.vector(4), uniform.vector(3)));
  scene.bodies[7].motion = Motion::kinematic;
  if (solver == Solver::impulse) return scene;
  physics.sleep = Sleep{0.5, 0.05};
  physics.attractors.push_back({Vector3d(3, 0, 4), 30, 2});
  scene.materials[0].friction = 0.5;
  scene.materials[0].rolling_resistance = 0.05;
  scene.boxes.push_back({});
  scene.boxes[0].size = Vector3d(4, 4, 1);
  const auto join = [&](JointKind kind, int a, std::optional<int> b) {
    Joint joint;
    joint.kind = kind;
    joint.a = a;
    joint.b = b;
    if (!b) joint.anchor_b = scene.bodies[static_cast<std::size_t>(a)].position;
    if (kind == JointKind::spring) joint.frequency = 3;
    scene.joints.push_back(joint);
  };
  join(JointKind::ball, 1, 2);
  join(JointKind::hinge, 2, 3);
  join(JointKind::spring, 4, {});
  join(JointKind::distance, 5, 6);
  return scene;
}

// With a sanitizer, steps are cancelled at a fifth of the polls.
#ifdef WITH_SANITIZER
constexpr int sparser = 5;
#else
constexpr int sparser = 1;
#endif

/// Cancels each step at every `stride`-th poll and compares with an uninterrupted run.
void expect_undone(const Scene& scene, RunOptions options, int steps, int stride, double uninterrupted) {
  stride *= sparser;
  World undisturbed(scene, options);
  Looks looks;
  looks.cancellation.uninterrupted = uninterrupted;
  options.cancellation = &looks.cancellation;
  World world(scene, options);
  int cancelled = 0;
  for (int step = 0; step < steps; ++step) {
    const std::string before = state_of(world);
    const StepStats stats = world.measure();
    int next = 1 + step % stride;
    while (looks.cancel_at(next, [&] { world.step(); })) {
      ++cancelled;
      next += stride;
      ASSERT_EQ(world.steps(), step);
      ASSERT_EQ(state_of(world), before) << "cancelled at look " << next - stride << " of step " << step;
      const StepStats now = world.measure();
      ASSERT_EQ(now.pairs, stats.pairs);
      ASSERT_EQ(now.speculative, stats.speculative);
      ASSERT_EQ(now.wall_impulse, stats.wall_impulse);
      ASSERT_EQ(now.push_work, stats.push_work);
    }
    undisturbed.step();
    ASSERT_EQ(world.steps(), step + 1);
    ASSERT_EQ(world.state_hash(), undisturbed.state_hash()) << "after step " << step;
  }
  EXPECT_EQ(state_of(world), state_of(undisturbed));
  EXPECT_GT(cancelled * sparser, steps) << "each step looks more than once";
}

class CancelledSteps : public testing::TestWithParam<std::tuple<Solver, Precision>> {
 protected:
  Scene scene() const { return busy_scene(std::get<0>(GetParam()), std::get<1>(GetParam())); }
};
INSTANTIATE_TEST_SUITE_P(Ways, CancelledSteps,
                         testing::Combine(testing::Values(Solver::impulse, Solver::soft_step,
                                                          Solver::jacobi_split),
                                          testing::Values(Precision::f32, Precision::f64)),
                         [](const auto& tested) {
                           return std::string(name_of(solver_names, std::get<0>(tested.param))) + "_" +
                                  std::string(name_of(precision_names, std::get<1>(tested.param)));
                         });

constexpr double no_solve = 0, whole_solve = 1e9;  // s, length of a solve that runs to its end

TEST_P(CancelledSteps, CommitNothingAtAnyLook) { expect_undone(scene(), on_cpu(1), 6, 7, no_solve); }

TEST_P(CancelledSteps, CommitNothingWhereShortSolvesRunToTheirEnd) {
  expect_undone(scene(), on_cpu(1), 6, 3, whole_solve);
}

TEST_P(CancelledSteps, CommitNothingWhileListsGrow) {
  RunOptions small = on_cpu(1);
  small.initial_pair_capacity = 8;
  expect_undone(scene(), small, 3, 5, no_solve);
  expect_undone(scene(), small, 3, 2, whole_solve);
}

TEST_P(CancelledSteps, CommitNothingWithLanes) {
  RunOptions lanes = on_cpu(2);
  lanes.shape = {2, 3};
  lanes.lane_order = LaneOrder::strided;
  expect_undone(scene(), lanes, 3, 11, no_solve);
}

TEST(Cancellation, LeavesNoTraceInAnyBroadPhase) {
  for (const std::string& method : broad_phase_names(ExecutorKind::cpu)) {
    SCOPED_TRACE(method);
    for (const int bits : {30, 63}) {
      RunOptions options = on_cpu(1);
      options.broad_phase = method;
      options.key_bits = bits;
      options.sort = bits == 63 ? SortMethod::radix : SortMethod::automatic;
      expect_undone(busy_scene(Solver::soft_step, Precision::f32), options, 3, 9, whole_solve);
    }
  }
}

TEST(Cancellation, FromAnotherThreadLeavesTheState) {
  Scene scene = box_collider(3000);
  scene.physics.solver = Solver::soft_step;
  World undisturbed(scene, on_cpu(3));
  Cancellation cancellation;
  cancellation.uninterrupted = 0;
  RunOptions options = on_cpu(3);
  options.cancellation = &cancellation;
  World world(scene, options);
  Uniform uniform{Random(5)};
  int cancelled = 0;
  for (int tries = 0; tries < 30; ++tries) {
    const auto wait = std::chrono::microseconds(static_cast<int>(uniform(0, 20'000)));
    std::thread other([&] {
      std::this_thread::sleep_for(wait);
      cancellation.request();
    });
    try {
      while (world.steps() < 30) world.step();
    } catch (const Cancelled&) {
      ++cancelled;
    }
    other.join();
    cancellation.clear();
    undisturbed.step(static_cast<int>(world.steps() - undisturbed.steps()));
    ASSERT_EQ(world.state_hash(), undisturbed.state_hash()) << "at state " << world.steps();
  }
  EXPECT_GT(cancelled, 0);
}

TEST(Cancellation, DuringADetectionOrAMeasureLeavesTheWorld) {
  const Scene scene = busy_scene(Solver::soft_step, Precision::f32);
  World undisturbed(scene, on_cpu(1));
  Looks looks;
  RunOptions options = on_cpu(1);
  options.cancellation = &looks.cancellation;
  World world(scene, options);
  int cancelled = 0;
  for (int k = 1;; ++k) {
    World fresh(scene, options);
    if (!looks.cancel_at(k, [&] { fresh.tree().quality(), fresh.measure(); })) break;
    ++cancelled;
    EXPECT_EQ(fresh.tree().quality().pairs, undisturbed.tree().quality().pairs);
    EXPECT_EQ(fresh.measure().speculative, undisturbed.measure().speculative);
    EXPECT_EQ(fresh.state_hash(), undisturbed.state_hash());
    EXPECT_EQ(fresh.pairs(), undisturbed.pairs());
  }
  EXPECT_GT(cancelled, 20);
}

/// A body exceeds the speed limit at a known step. The finding is reported or the body frozen, even if the
/// step was cancelled before.
TEST(Cancellation, WhileAFindingIsReadChangesNothing) {
  for (const auto& [name, solver, help] : solver_names)
    for (const OnFailure on_failure : {OnFailure::pause, OnFailure::freeze}) {
      SCOPED_TRACE(name);
      Scene scene = busy_scene(solver, Precision::f32);
      scene.physics.guards = ValidationSettings{.speed = 8};
      scene.physics.guards->on_failure = on_failure;
      scene.bodies.push_back(sphere(0.3, Vector3d(5, 5, 11), Vector3d(0, 0, -6)));
      const RunOptions plain = on_cpu(1);
      World undisturbed(scene, plain);
      undisturbed.step(16);
      ASSERT_TRUE(undisturbed.validation().finding());
      Looks looks;
      looks.cancellation.uninterrupted = no_solve;
      RunOptions options = plain;
      options.cancellation = &looks.cancellation;
      World world(scene, options);
      int next = 1;
      while (world.steps() < 16 && !world.validation().paused()) {
        const bool cancelled = looks.cancel_at(next, [&] { world.step(); });
        next = cancelled ? next + 13 * sparser : 1;
      }
      EXPECT_EQ(world.steps(), undisturbed.steps());
      EXPECT_EQ(world.validation().paused(), undisturbed.validation().paused());
      EXPECT_EQ(world.validation().frozen(), undisturbed.validation().frozen());
      ASSERT_TRUE(world.validation().finding());
      EXPECT_EQ(describe(*world.validation().finding()), describe(*undisturbed.validation().finding()));
      EXPECT_EQ(state_of(world), state_of(undisturbed));
    }
}

TEST(Cancellation, EndsTheMakingOfAWorld) {
  Scene apart = box_collider(3000, Variant::scaled);
  apart.generators[0].spawn = Spawn::apart;
  Scene settled = box_collider(40, Variant::settled);
  const TemporaryFolder cache;
  setenv("XDG_CACHE_HOME", (cache / "").c_str(), 1);
  for (const Scene& scene : {apart, settled}) {
    Looks looks;
    RunOptions options = on_cpu(1);
    options.cancellation = &looks.cancellation;
    for (const int k : {1, 2, 3, 5, 40})
      EXPECT_TRUE(looks.cancel_at(k, [&] { World(scene, options).measure(); })) << "look " << k;
    World undisturbed(scene, on_cpu(1)), world(scene, options);
    EXPECT_EQ(world.state_hash(), undisturbed.state_hash());
  }
  unsetenv("XDG_CACHE_HOME");
}

class CancelledWorlds : public OnEachExecutor {};
ON_EACH_EXECUTOR(CancelledWorlds);

/// As Esc in the window: the run, and a run in construction.
TEST_P(CancelledWorlds, ContinueAfterARequestBetweenSteps) {
  const Scene scene = busy_scene(Solver::soft_step, Precision::f32);
  World undisturbed(scene, options());
  Cancellation cancellation;
  int polls_left = 0;
  cancellation.set_poll(
      [&] {
        if (--polls_left == 0) cancellation.request_between_steps();
      },
      {});
  RunOptions cancellable = options();
  cancellable.cancellation = &cancellation;
  World world(scene, cancellable);
  int cancelled = 0;
  for (int k = 0; k < 24; ++k) {
    const auto cancel = [&](const auto& work) {
      polls_left = 1 + k % 4;
      try {
        work();
      } catch (const Cancelled&) {
        ++cancelled;
      }
      polls_left = 0;
      cancellation.clear();
    };
    cancel([&] { world.step(5); });
    const RunState state = world.state();
    cancel([&] { World(scene, cancellable, &state).step(5); });
    undisturbed.step(static_cast<int>(world.steps() - undisturbed.steps()));
    ASSERT_EQ(state_of(world), state_of(undisturbed)) << "at state " << world.steps();
    world.step();
  }
  EXPECT_EQ(cancelled, 2 * 24);
}

TEST(Cancellation, KeepsToOneThreadWithItsPolls) {
  Cancellation cancellation;
  std::atomic<int> strangers = 0, polls = 0;
  const std::thread::id own = std::this_thread::get_id();
  cancellation.set_poll(
      [&] {
        ++polls;
        strangers += std::this_thread::get_id() != own;
      },
      {});
  RunOptions options = on_cpu(4);
  options.cancellation = &cancellation;
  World world(box_collider(4000), options);
  world.step(3);
  EXPECT_GT(polls, 100);
  EXPECT_EQ(strangers, 0);
}

/// With slow items, only few items run between two polls.
TEST(Cancellation, IsSeenBetweenSlowItems) {
  for (const int threads : {1, 3}) {
    ThreadTeam team(threads);
    Cancellation cancellation;
    team.set_cancellation(&cancellation);
    struct Work {
      Cancellation& cancellation;
      std::atomic<int> done = 0;
    } work{cancellation};
    const auto slow = [](void* context, std::int64_t begin, std::int64_t end) {
      Work& w = *static_cast<Work*>(context);
      for (std::int64_t k = begin; k < end; ++k) {
        std::this_thread::sleep_for(std::chrono::milliseconds(15));
        if (++w.done == 20) w.cancellation.request();
      }
    };
    EXPECT_THROW(team.parallel_for(100'000, 512, slow, &work), Cancelled);
    EXPECT_LT(work.done, 20 + 8 * threads);
    EXPECT_TRUE(team.stopped());
    cancellation.clear();
    team.resume();
    work.done = 1000;
    team.parallel_for(3, 512, slow, &work);
    EXPECT_EQ(work.done, 1003);
  }
}

}  // namespace
}  // namespace collidoscope
