// Tests that test runs in parallel give the same results as single runs.

#include "headless/stability/test_pool.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/scenes.h"

namespace collidoscope {
namespace {

HardCase gas(int steps) {
  HardCase one;
  one.name = "gas";
  one.scene = box_collider(100);
  one.criterion.steps = steps;
  one.criterion.assertions.emplace_back().at_most = 0;
  return one;
}

std::vector<TestRun> all_test_runs(const HardCase& one) {
  RunOptions options;
  options.executor = ExecutorKind::cpu;
  options.cpu_threads = 1;
  std::vector<TestRun> test_runs;
  for (const TestConfiguration& configuration : test_configurations(one, ExecutorKind::cpu))
    test_runs.emplace_back(one, configuration, options);
  return test_runs;
}

TEST(TestPool, SideBySideTheyComeToTheSame) {
  const HardCase one = gas(30);
  std::vector<TestRun> alone = all_test_runs(one), together = all_test_runs(one);
  run_tests(alone, 1, [](std::int64_t) { return true; });
  std::int64_t most = 0;
  run_tests(together, 4, [&](std::int64_t done) {
    EXPECT_GE(done, most);
    most = done;
    return true;
  });
  EXPECT_EQ(alone.size(), 6u);
  for (std::size_t k = 0; k < alone.size(); ++k) {
    EXPECT_TRUE(alone[k].done() && together[k].done());
    EXPECT_EQ(alone[k].result().outcome, TestOutcome::passed) << alone[k].result().why;
    EXPECT_EQ(alone[k].result().state_hash, together[k].result().state_hash);
  }
}

TEST(TestPool, StopsWhereItIsTold) {
  const HardCase one = gas(1'000'000'000);
  std::vector<TestRun> test_runs = all_test_runs(one);
  run_tests(test_runs, 2, [](std::int64_t) { return false; });
  for (const TestRun& test_run : test_runs) EXPECT_FALSE(test_run.done());
}

TEST(TestPool, RunsLargeTrialsOneAtATime) {
  const HardCase one = gas(1'000'000'000);
  for (const bool large : {true, false}) {
    std::vector<TestRun> test_runs = all_test_runs(one);
    int calls = 0;
    run_tests(
        test_runs, 3, [&](std::int64_t) { return ++calls < 5; }, large ? 99 : 100);
    EXPECT_EQ(
        std::ranges::count_if(test_runs, [](const TestRun& test_run) { return test_run.progress() > 0; }),
        large ? 1 : 3);
  }
}

TEST(TestPool, HasNothingToDoWithoutTrials) {
  run_tests({}, 3, [](std::int64_t) { return true; });
}

}  // namespace
}  // namespace collidoscope
