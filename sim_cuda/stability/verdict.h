#pragma once
// Results of assertions and the outcome of a test run.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/stability/criterion.h"
#include "sim_cuda/stability/quantities.h"
#include "sim_cuda/stability/test_run.h"

namespace collidoscope {

/// Updates the result of an assertion with the values at a state.
void update(AssertionResult& known, const Assertion& assertion, const Extremes& extremes, std::int64_t state);

/// "penetration at most 0.01 m: 0.02 m at state 7, body 3; up to 0.1 m". `finding`: of the guards, or empty.
std::string failure_text(const Assertion& assertion, const AssertionResult& known,
                         const std::string& finding);

/// Sets outcome, reason and failure. A declared limit excuses the terms that it names, within its bounds. All
/// of them must fail. `broken`: the run ended early, for the reason in `result.failure`; nothing excuses it.
void judge(TestResult& result, const std::vector<Assertion>& assertions, const ExpectedFailure* limit,
           bool broken, const std::string& finding);

}  // namespace collidoscope
