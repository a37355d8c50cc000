#pragma once
// Runs test runs in parallel, one thread each. Stateless.

#include <functional>
#include <span>

#include "sim_cuda/stability/test_run.h"

namespace collidoscope {

/// Completes all test runs in order, `jobs` in parallel. Calls `on_progress` about ten times a second on the
/// caller's thread with the number of completed runs. If it returns false, the remaining runs stop.
/// Runs with more than `max_parallel_bodies` bodies do not overlap each other, because several would exceed
/// the memory of one GPU.
void run_tests(std::span<TestRun> test_runs, int jobs,
               const std::function<bool(std::int64_t done)>& on_progress,
               std::int64_t max_parallel_bodies = 1'000'000);

}  // namespace collidoscope
