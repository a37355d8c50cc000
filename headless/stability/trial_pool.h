#pragma once
// Trials side by side, each on a thread of its own. A free function.

#include <functional>
#include <span>

#include "sim_cuda/stability/trial.h"

namespace collidoscope {

/// Runs all to their ends, `jobs` at a time, in order. `told` is called every tenth of a second or so, on the
/// caller's thread, with the trials that are done, and whether to go on; where it says no, trials stop where
/// they are.
void run_trials(std::span<Trial> trials, int jobs, const std::function<bool(std::int64_t done)>& told);

}  // namespace collidoscope
