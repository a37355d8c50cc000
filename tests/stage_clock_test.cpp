// Tests the timing of stages: sums within a step, percentiles, and a repeated step that does not count.
#include "sim_cuda/core/stage_clock.h"
#include "sim_cuda/core/statistics.h"

#include <gtest/gtest.h>

namespace collidoscope {
namespace {

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  EXPECT_EQ(quantile<float>({}, 0.5), 0);
  EXPECT_EQ(quantile<float>({7}, 0.95), 7);
  EXPECT_DOUBLE_EQ(quantile<float>({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile<float>({1, 2, 3, 4, 5}, 0.25), 2);
  EXPECT_DOUBLE_EQ(quantile<float>({5, 1}, 1), 5);
}

TEST(TimeSamples, KeepTheMostRecentOnes) {
  TimeSamples samples;
  EXPECT_EQ(samples.last(), 0);
  for (std::size_t k = 0; k < TimeSamples::capacity; ++k) samples.add(1);
  for (std::size_t k = 0; k < TimeSamples::capacity; ++k) samples.add(2);
  samples.add(3);
  EXPECT_EQ(samples.recent().size(), TimeSamples::capacity);
  EXPECT_EQ(samples.count(), static_cast<std::int64_t>(2 * TimeSamples::capacity + 1));
  EXPECT_EQ(samples.last(), 3);
  EXPECT_EQ(quantile(samples.recent(), 0), 2);
}

TEST(StageClock, AddsUpTheRunsOfAStageWithinAStep) {
  StageClock clock;
  const std::size_t build = clock.index(clock.entry("build")), pairs = clock.index(clock.entry("pairs"));
  clock.add(build, 1);
  clock.add(pairs, 5);
  clock.add(build, 2);
  clock.commit_step();
  clock.add(build, 100);
  clock.discard_step();  // an overflow: the step is repeated
  clock.add(build, 4);
  clock.commit_step();
  const RunTimes times = clock.times();
  ASSERT_EQ(times.stages.size(), 2u);
  EXPECT_EQ(times.stages[0].name, "build");
  EXPECT_EQ(times.stages[0].median_ms, 3.5);
  EXPECT_EQ(times.stages[0].last_ms, 4);
  EXPECT_EQ(times.stages[1].median_ms, 2.5);
  EXPECT_EQ(times.steps_timed, 0) << "instrumented steps are not plain ones";
  clock.add_plain_step(9);
  EXPECT_EQ(clock.times().step_median_ms, 9);
  EXPECT_EQ(clock.latest().step_last_ms, 9);
}

}  // namespace
}  // namespace collidoscope
