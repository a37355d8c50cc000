// Tests the occupancy limits of kernels against NVIDIA's occupancy calculator for compute capability 9.0.

#include "sim_cuda/core/occupancy.h"

#include <gtest/gtest.h>

namespace collidoscope {
namespace {

constexpr MultiprocessorLimits hopper{2048, 32, 228 * 1024, 1024};

TEST(Occupancy, NamesWhatRunsOut) {
  EXPECT_EQ(residency_limit(hopper, 256, 0, 8), LaunchLimit::threads);    // 32 registers: full occupancy
  EXPECT_EQ(residency_limit(hopper, 256, 0, 4), LaunchLimit::registers);  // 64 registers: half of it
  EXPECT_EQ(residency_limit(hopper, 32, 0, 32), LaunchLimit::blocks);     // 1,024 threads in total
  EXPECT_EQ(residency_limit(hopper, 64, 48 * 1024, 4), LaunchLimit::shared_memory);
  EXPECT_EQ(residency_limit(hopper, 1024, 0, 2), LaunchLimit::threads);
  EXPECT_EQ(residency_limit(hopper, 37, 0, 32), LaunchLimit::threads) << "takes two warps, as 64 threads do";
  EXPECT_EQ(residency_limit(hopper, 768, 0, 2), LaunchLimit::threads) << "a third block does not fit";
}

TEST(Occupancy, ALaunchMayNotFillTheDevice) {
  const LaunchLimit full = LaunchLimit::registers;
  EXPECT_EQ(launch_limit(8, 8, 1056, full), LaunchLimit::items);
  EXPECT_EQ(launch_limit(1056, 4000, 1056, full), full);
  EXPECT_EQ(launch_limit(4000, 4000, 1056, full), full);
  EXPECT_EQ(launch_limit(16, 4000, 1056, full), LaunchLimit::shape) << "more would find items";
  EXPECT_EQ(launch_limit(65536, 8, 1056, full), LaunchLimit::items) << "most blocks find none";
  EXPECT_EQ(launch_limit(4, 8, 1056, full), LaunchLimit::shape);
  EXPECT_EQ(launch_limit(1056, 1056, 1056, full), full);
}

}  // namespace
}  // namespace collidoscope
