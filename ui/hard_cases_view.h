#pragma once
// Data of the hard cases panel. Plain structs: the panel writes the requests, the caller writes the view. A
// hard case is a stress scene. A test run is a case with one solver in one precision.

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

/// Result of one assertion: the value nearest to the bound, or the first value beyond it.
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
  double progress = 0;                       ///< 0 to 1, while running
  std::string why, failure;                  ///< reason of a limit or of "not applicable"; failed assertion
  std::vector<AssertionView> assertions;     ///< measured assertions
  std::int64_t steps = 0;                    ///< number of completed steps
  double seconds = 0;                        ///< wall-clock time
  std::optional<std::int64_t> failed_state;  ///< failing state that can be opened
  std::optional<std::uint32_t> body;         ///< failing body, if any

  bool is_finished() const { return status >= TestStatus::passed; }
};

struct HardCaseView {
  std::string name, what, group;
  bool refused = false;  ///< the reader must reject the scene; it cannot be opened and has one test run
  std::vector<TestRunView> test_runs;  ///< ordered by solver, then by precision
};

struct HardCasesView {
  std::vector<HardCaseView> cases;            ///< ordered by group
  std::string executor;                       ///< executor of the test runs
  std::string unavailable_reason;             ///< why there are no cases; empty: available
  std::string current_task;                   ///< short text; empty: idle
  std::optional<double> opening;              ///< 0 to 1: progress of the run to the requested state
  std::optional<std::size_t> shown;           ///< index of the case in the 3D view
  std::optional<std::size_t> shown_test_run;  ///< index of its test run
  std::string scene_before;                   ///< scene that was replaced by a case; empty: none

  std::int64_t count(TestStatus status) const {
    std::int64_t n = 0;
    for (const HardCaseView& hard_case : cases)
      for (const TestRunView& test_run : hard_case.test_runs) n += test_run.status == status;
    return n;
  }
};

struct HardCasesRequests {
  std::string selected;  ///< name of the selected case; empty: none
  // Cleared by the caller.
  bool run_all = false, run_selected = false, stop = false;
  bool back = false;  ///< return to the replaced scene
  struct Opening {
    std::size_t which;  ///< index of the case
    std::optional<std::size_t>
        test_run;  ///< index of its test run, opened at the failing state; unset: the case at state 0
  };
  std::optional<Opening> open;
};

}  // namespace collidoscope
