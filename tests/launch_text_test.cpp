// Tests the texts about kernel launches in the panels.

#include "ui/launch_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

StageTime timed(const char* name, const StageLaunch& launch, bool library_launch = false) {
  StageTime time;
  time.name = name;
  time.last_ms = 1;
  time.launches = 3;
  time.library_launch = library_launch;
  time.launch = launch;
  return time;
}

StageLaunch on_gpu(std::int64_t blocks, int threads, double occupancy, LaunchLimit limit) {
  return {.items = 1'000'000,
          .blocks = blocks,
          .threads = threads,
          .resident_blocks = 4,
          .multiprocessors = 132,
          .registers = 40,
          .occupancy = occupancy,
          .limit = limit};
}

History history_of(const std::vector<StageTime>& stages) {
  History history;
  history.add({}, stages);
  return history;
}

TEST(LaunchText, SaysWhatAndWhy) {
  const History history =
      history_of({timed("full", on_gpu(528, 256, 0.5, LaunchLimit::registers)),
                  timed("few", on_gpu(1, 256, 1, LaunchLimit::items), true),
                  timed("asked", on_gpu(16, 32, 0.5, LaunchLimit::shape)), timed("sort", {}, true),
                  timed("cpu", {.items = 2000, .blocks = 4, .threads = 2, .chunk = 512})});
  const auto text = [&](std::size_t stage) { return launch_text(history.stages()[stage]); };
  EXPECT_THAT(text(0), HasSubstr("528 blocks of 256 threads for 1,000,000 items"));
  EXPECT_THAT(text(0), HasSubstr("4 resident blocks on each of 132 multiprocessors: occupancy 50 %"));
  EXPECT_THAT(text(0), HasSubstr("limited by registers"));
  EXPECT_THAT(text(1), HasSubstr("1 block of 256 threads"));
  EXPECT_THAT(text(1), HasSubstr("too few items"));
  EXPECT_THAT(text(1), HasSubstr("some kernels have a library launch shape"));
  EXPECT_THAT(text(2), HasSubstr("room for 512 more blocks"));
  EXPECT_EQ(text(3), "library launch shape: independent of (B, T)");
  EXPECT_THAT(text(4), HasSubstr("2,000 items in 4 chunks of 512, on 2 threads"));
}

TEST(LaunchText, TheRangeIsOfTheNewestStep) {
  EXPECT_TRUE(launch_range(History()).lines.empty());
  History history = history_of({timed("old", on_gpu(7, 64, 0.1, LaunchLimit::blocks))});
  history.add({}, {timed("a", on_gpu(528, 256, 0.5, LaunchLimit::registers)),
                   timed("b", on_gpu(1, 192, 1, LaunchLimit::items)),
                   timed("c", on_gpu(8, 256, 1, LaunchLimit::items)), timed("sort", {}, true)});
  const LaunchRange range = launch_range(history);
  EXPECT_EQ(range.blocks, "1 to 528");
  EXPECT_EQ(range.threads, "192 to 256");
  EXPECT_THAT(range.lines,
              ElementsAre("occupancy 50 to 100 %", "2 stages: too few items", "1 stage: registers"));
  const LaunchRange cpu =
      launch_range(history_of({timed("a", {.items = 1, .blocks = 1, .threads = 1, .chunk = 512}),
                               timed("b", {.items = 2000, .blocks = 4, .threads = 2, .chunk = 512})}));
  EXPECT_EQ(cpu.blocks, "");
  EXPECT_THAT(cpu.lines, ElementsAre("CPU: chunks of 512 items on 2 threads"));
}

}  // namespace
}  // namespace collidoscope
