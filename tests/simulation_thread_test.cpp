// Tests the simulation thread: the states that it reaches and publishes, and how it starts, pauses and stops.

#include "viewer/view/simulation_thread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <stdexcept>
#include <thread>

#include "sim_cuda/scene/scene_file.h"
#include "tests/executors.h"
#include "tests/falling_scene.h"

namespace collidoscope {
namespace {

using std::chrono::milliseconds;
using TestClock = std::chrono::steady_clock;
constexpr milliseconds long_enough(60'000);

Scene bodies_in_a_box(std::int64_t bodies) {
  Scene scene;
  scene.box = Box{};
  BoxCollider generator;
  generator.count = bodies;
  scene.generators.push_back(generator);
  return scene;
}

SimulationThread::Plan at_once() {
  SimulationThread::Plan plan;
  plan.at_once = true;
  plan.request.layers.spheres = plan.request.layers.contacts = true;
  return plan;
}

class SimulationThreads : public OnEachExecutor {
 protected:
  struct Run {
    Run(const Scene& scene, const RunOptions& options) : live(scene, options), thread(live, breaks, {}) {}
    bool wait() {  // until it pauses by itself
      const auto end = TestClock::now() + long_enough;
      while (!thread.paused() && TestClock::now() < end) std::this_thread::sleep_for(milliseconds(1));
      return thread.paused();
    }
    LiveWorld live;
    LiveBreakpoints breaks;
    SimulationThread thread;
  };
};
ON_EACH_EXECUTOR(SimulationThreads);

TEST_P(SimulationThreads, PausesAnywhereAndReachesTheSameStates) {
  std::mt19937 random(1);
  Run run(bodies_in_a_box(200), options());
  LiveWorld plain(bodies_in_a_box(200), options());
  std::int64_t steps = 0;
  for (int k = 0; k < 12; ++k) {
    run.thread.start(at_once());
    std::this_thread::sleep_for(milliseconds(random() % 8));
    ASSERT_TRUE(run.thread.pause(long_enough));
    const SimulationThread::Result result = run.thread.take_result();
    EXPECT_FALSE(result.error);
    steps += result.steps;
    ASSERT_EQ(run.live.world().steps(), steps);
    while (plain.world().steps() < steps) plain.step(false);
    ASSERT_EQ(run.live.state_hash(), plain.state_hash());
    // A change between two starts belongs to this state.
    Settings request = plain.settings();
    request.material.restitution = 0.1 * (k % 5);
    run.live.apply(request);
    plain.apply(request);
  }
  EXPECT_GT(steps, 0);
  EXPECT_EQ(run.live.changes_text(), plain.changes_text());
}

TEST_P(SimulationThreads, PublishesWholeStates) {
  Run run(bodies_in_a_box(300), options());
  World plain(bodies_in_a_box(300), options());
  SimulationThread::Plan plan = at_once();
  plan.request.selection = 0;
  run.thread.start(plan);
  auto state = std::make_unique<PublishedState>();
  PublishedRecords expected;
  std::int64_t before = 0;
  const auto end = TestClock::now() + long_enough;
  for (int taken = 0; taken < 20 && TestClock::now() < end;) {
    plan.request.selection = static_cast<std::uint32_t>(taken);  // while it runs
    run.thread.update(plan);
    if (!run.thread.take(state)) {
      std::this_thread::sleep_for(milliseconds(1));
      continue;
    }
    ++taken;
    ASSERT_GT(state->key.step, before) << "no state is published twice";
    before = state->key.step;
    plain.step(static_cast<int>(before - plain.steps()));
    plain.publisher().copy(plan.request.layers, expected);
    const auto bodies = state->records.copy<BodyInstance>(), same = expected.copy<BodyInstance>();
    ASSERT_EQ(bodies.size(), 300u);
    EXPECT_EQ(std::memcmp(bodies.data(), same.data(), bodies.size() * sizeof bodies[0]), 0);
    EXPECT_EQ(state->records.copy<ContactInstance>().size(), expected.copy<ContactInstance>().size());
    EXPECT_EQ(state->view.stats.step, before);
    EXPECT_EQ(state->view.stats.kinetic_energy, plain.measure().kinetic_energy);
    EXPECT_EQ(state->history[state->history.size() - 1].step, before);
    ASSERT_TRUE(state->selected);
    EXPECT_EQ(state->selected_step, before);
    EXPECT_EQ(state->selected->X, plain.inspect(state->selected->id).X);
  }
  EXPECT_GE(before, 20);
}

TEST_P(SimulationThreads, MakesOneStepPerTakenState) {
  Run run(bodies_in_a_box(50), options());
  SimulationThread::Plan plan = at_once();
  plan.at_once = false;
  plan.speed = 0;
  run.thread.start(plan);
  auto state = std::make_unique<PublishedState>();
  for (std::int64_t k = 1; k <= 10; ++k) {
    const auto end = TestClock::now() + long_enough;
    while (!run.thread.take(state) && TestClock::now() < end) std::this_thread::sleep_for(milliseconds(1));
    EXPECT_EQ(state->key.step, k);
    std::this_thread::sleep_for(milliseconds(k % 3));  // a slow frame
  }
}

TEST_P(SimulationThreads, StopWhereTheyAreAsked) {
  Run run(parse_scene(falling_scene(), "falling"), options());
  SimulationThread::Plan plan = at_once();
  plan.pause_at = 3;
  run.thread.start(plan);
  ASSERT_TRUE(run.wait());
  EXPECT_TRUE(run.thread.take_result().reached);
  EXPECT_EQ(run.live.world().steps(), 3);

  plan.conditions.limit(BreakCondition::speed) = 5.5;
  run.thread.start(plan);
  ASSERT_TRUE(run.wait());
  const SimulationThread::Result result = run.thread.take_result();
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.steps, 2);
  EXPECT_NEAR(result.simulated, 0.2, 1e-12);
  EXPECT_EQ(run.live.world().steps(), 5);
  ASSERT_TRUE(run.breaks.stop(run.live));

  run.breaks.resume();
  run.thread.start(plan, 4);
  ASSERT_TRUE(run.wait());
  EXPECT_EQ(run.thread.take_result().steps, 4);
}

TEST_P(SimulationThreads, DoOtherWorkFirst) {
  Run run(bodies_in_a_box(50), options());
  run.thread.start(at_once(), 5, [&] {
    run.live.restart();
    return false;
  });
  ASSERT_TRUE(run.wait());
  EXPECT_EQ(run.thread.take_result().steps, 0);
  EXPECT_EQ(run.live.generation(), 1);

  run.thread.start(at_once(), 5, []() -> bool { throw std::runtime_error("out of paper"); });
  ASSERT_TRUE(run.wait());
  const SimulationThread::Result failed = run.thread.take_result();
  EXPECT_THAT([&] { std::rethrow_exception(failed.error); },
              testing::ThrowsMessage<std::runtime_error>("out of paper"));
  EXPECT_EQ(run.live.world().steps(), 0);

  run.thread.start(at_once(), 5, [&] {
    while (!run.thread.must_pause()) std::this_thread::sleep_for(milliseconds(1));
    return true;
  });
  EXPECT_FALSE(run.thread.paused());
  EXPECT_TRUE(run.thread.pause(long_enough));
  EXPECT_EQ(run.thread.take_result().steps, 1) << "the step that is due is made, and no other";
}

TEST_P(SimulationThreads, MakeARequestedStepEvenIfAPauseFollowsAtOnce) {
  Run run(bodies_in_a_box(20), options());
  for (std::int64_t k = 1; k <= 200; ++k) {
    run.thread.start(at_once(), 1);
    ASSERT_TRUE(run.thread.pause(long_enough));
    ASSERT_EQ(run.live.world().steps(), k);
  }
}

TEST(SimulationThread, IsNeverFasterThanItsSpeed) {
  LiveWorld live(parse_scene(falling_scene(), "falling"), on_cpu(1));
  LiveBreakpoints breaks;
  int published = 0;
  SimulationThread thread(live, breaks, [&] { ++published; });
  SimulationThread::Plan plan;
  plan.speed = 2;
  const auto start = TestClock::now();
  thread.start(plan);
  while (TestClock::now() - start < milliseconds(700)) {
    const double simulated = thread.simulated();
    const double seconds = std::chrono::duration<double>(TestClock::now() - start).count();
    ASSERT_LE(simulated, 2 * seconds + 0.1 + 1e-9) << "one step ahead at most";
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_GT(thread.simulated(), 0.2);
  ASSERT_TRUE(thread.pause(long_enough));
  EXPECT_GE(published, 1);
}

TEST(SimulationThread, EndsWhileItRuns) {
  LiveWorld live(bodies_in_a_box(100), on_cpu(2));
  LiveBreakpoints breaks;
  SimulationThread thread(live, breaks, {});
  thread.start(at_once());
}

}  // namespace
}  // namespace collidoscope
