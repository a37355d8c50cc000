#pragma once
// Trials side by side, each on a thread of its own. A free function.

#include <functional>
#include <span>

#include "sim_cuda/stability/trial.h"

namespace collidoscope {

/// Runs all to their ends, `jobs` at a time, in order. `told` is called every tenth of a second or so, on the
/// caller's thread, with the trials that are done, and whether to go on; where it says no, trials stop where
/// they are. Of trials with more than `most_bodies`, one runs at a time: several would not fit into one GPU's
/// memory.
void run_trials(std::span<Trial> trials, int jobs, const std::function<bool(std::int64_t done)>& told,
                std::int64_t most_bodies = 1'000'000);

}  // namespace collidoscope
