#pragma once
// Test runs side by side, each on a thread of its own. A free function.

#include <functional>
#include <span>

#include "sim_cuda/stability/test_run.h"

namespace collidoscope {

/// Runs all to their ends, `jobs` at a time, in order. `on_progress` is called every tenth of a second or so,
/// on the caller's thread, with the test runs that are done, and whether to go on; where it says no, test
/// runs stop where they are. Of test runs with more than `max_parallel_bodies`, one runs at a time: several
/// would not fit into one GPU's memory.
void run_tests(std::span<TestRun> test_runs, int jobs,
               const std::function<bool(std::int64_t done)>& on_progress,
               std::int64_t max_parallel_bodies = 1'000'000);

}  // namespace collidoscope
