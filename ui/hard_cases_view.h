#pragma once
// What the panel of hard cases shows and asks for. Plain data: the requests are the panel's, the view its
// owner's. A case is a scene that tries to break the simulation; a test run of it is one solver in one
// precision.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

enum class TestStatus { not_run, waiting, running, passed, expected_failure, failed, not_applicable };
inline constexpr auto test_status_names =
    std::to_array<Named<TestStatus>>({{"not run", TestStatus::not_run},
                                      {"waiting", TestStatus::waiting},
                                      {"running", TestStatus::running},
                                      {"passed", TestStatus::passed},
                                      {"declared limit", TestStatus::expected_failure},
                                      {"failed", TestStatus::failed},
                                      {"not applicable", TestStatus::not_applicable}});

/// What came of one assertion: its value nearest to the bound, or the first beyond it.
struct AssertionView {
  std::string assertion, value;  ///< "penetration at most 0.01 m", "0.00123 m"
  bool passed = true;
  std::int64_t state = 0;
  std::optional<std::uint32_t> body;
};

struct TestRunView {
  Solver solver = Solver::soft_step;
  Precision precision = Precision::f32;
  TestStatus status = TestStatus::not_run;
  double progress = 0;                    ///< 0 to 1, of one that is running
  std::string why, failure;               ///< reason of a limit, or why it does not apply; what did not hold
  std::vector<AssertionView> assertions;  ///< that were measured
  std::int64_t steps = 0;                 ///< made
  double seconds = 0;                     ///< of the clock
  std::optional<std::int64_t> failed_state;  ///< where it can be looked at
  std::optional<std::uint32_t> body;         ///< that failed there, if it was one

  bool is_finished() const { return status >= TestStatus::passed; }
};

struct HardCaseView {
  std::string name, what, group;
  bool refused = false;  ///< its scene must be refused, so nothing of it can be opened; it has one test run
  std::vector<TestRunView> test_runs;  ///< by solver, then by precision
};

struct HardCasesView {
  std::vector<HardCaseView> cases;            ///< by group
  std::string executor;                       ///< that test runs run on
  std::string unavailable_reason;             ///< why there are none, or empty
  std::string current_task;                   ///< in a few words; empty: nothing runs
  std::optional<double> opening;              ///< 0 to 1: how far a run has come on its way to a state
  std::optional<std::size_t> shown;           ///< the case that is in the 3D view,
  std::optional<std::size_t> shown_test_run;  ///< and which of its test runs
  std::string scene_before;  ///< the scene that was there before all cases; empty: it still is

  std::int64_t count(TestStatus status) const {
    std::int64_t n = 0;
    for (const HardCaseView& hard_case : cases)
      for (const TestRunView& test_run : hard_case.test_runs) n += test_run.status == status;
    return n;
  }
};

struct HardCasesRequests {
  std::string selected;  ///< name of a case; empty: none
  // Cleared by the owner.
  bool run_all = false, run_selected = false, stop = false;
  bool back = false;  ///< to the scene that was there before
  struct Opening {
    std::size_t which;  ///< of the cases
    std::optional<std::size_t>
        test_run;  ///< of its test runs, at the state where it failed; unset: the case at 0
  };
  std::optional<Opening> open;
};

}  // namespace collidoscope
