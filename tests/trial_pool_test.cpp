// Trials side by side come to what they come to alone.

#include "headless/stability/trial_pool.h"

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
  one.criterion.holds.emplace_back().at_most = 0;
  return one;
}

std::vector<Trial> trials_of_all(const HardCase& one) {
  RunOptions options;
  options.executor = ExecutorKind::cpu;
  options.cpu_threads = 1;
  std::vector<Trial> trials;
  for (const TrialSetting& setting : trials_of(one, ExecutorKind::cpu))
    trials.emplace_back(one, setting, options);
  return trials;
}

TEST(TrialPool, SideBySideTheyComeToTheSame) {
  const HardCase one = gas(30);
  std::vector<Trial> alone = trials_of_all(one), together = trials_of_all(one);
  run_trials(alone, 1, [](std::int64_t) { return true; });
  std::int64_t most = 0;
  run_trials(together, 4, [&](std::int64_t done) {
    EXPECT_GE(done, most);
    most = done;
    return true;
  });
  EXPECT_EQ(alone.size(), 6u);
  for (std::size_t k = 0; k < alone.size(); ++k) {
    EXPECT_TRUE(alone[k].done() && together[k].done());
    EXPECT_EQ(alone[k].result().verdict, Verdict::passed) << alone[k].result().why;
    EXPECT_EQ(alone[k].result().state_hash, together[k].result().state_hash);
  }
}

TEST(TrialPool, StopsWhereItIsTold) {
  const HardCase one = gas(1'000'000'000);
  std::vector<Trial> trials = trials_of_all(one);
  run_trials(trials, 2, [](std::int64_t) { return false; });
  for (const Trial& trial : trials) EXPECT_FALSE(trial.done());
}

TEST(TrialPool, RunsLargeTrialsOneAtATime) {
  const HardCase one = gas(1'000'000'000);
  for (const bool large : {true, false}) {
    std::vector<Trial> trials = trials_of_all(one);
    int calls = 0;
    run_trials(
        trials, 3, [&](std::int64_t) { return ++calls < 5; }, large ? 99 : 100);
    EXPECT_EQ(std::ranges::count_if(trials, [](const Trial& trial) { return trial.progress() > 0; }),
              large ? 1 : 3);
  }
}

TEST(TrialPool, HasNothingToDoWithoutTrials) {
  run_trials({}, 3, [](std::int64_t) { return true; });
}

}  // namespace
}  // namespace collidoscope
