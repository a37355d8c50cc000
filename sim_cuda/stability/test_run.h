#pragma once
// A test run: one hard case with one solver, precision and executor. Runs to the last state, or until a body
// is not finite, in time slices, so that a viewer can draw in between. A failed assertion does not end it, so
// that all others are evaluated. Not thread-safe; concurrent test runs share no data.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "sim_cuda/stability/hard_case.h"

namespace collidoscope {

/// The configuration of a test run.
struct TestConfiguration {
  Solver solver = Solver::soft_step;
  Precision precision = Precision::f32;
  ExecutorKind executor = ExecutorKind::cpu;  ///< cpu or cuda

  friend bool operator==(const TestConfiguration&, const TestConfiguration&) = default;
};

enum class TestOutcome { passed, failed, expected_failure, not_applicable };
inline constexpr auto test_outcome_names =
    std::to_array<Named<TestOutcome>>({{"passed", TestOutcome::passed},
                                       {"failed", TestOutcome::failed},
                                       {"declared limit", TestOutcome::expected_failure},
                                       {"not applicable", TestOutcome::not_applicable}});

/// Result of one assertion: the measured value nearest to its bound, or the first one beyond it.
struct AssertionResult {
  bool measured = false, passed = true;
  double value = 0, bound = 0;
  std::int64_t state = 0;
  std::optional<std::uint32_t> body;
  double least = 0, most = 0;  ///< of all measured states; NaN if a value was NaN

  /// The value farthest beyond the bound; `value` if the assertion holds.
  double worst() const;
};

struct TestResult {
  TestOutcome outcome = TestOutcome::passed;
  /// One line: the failure, the reason of the expected failure, or the reason for not being applicable.
  /// Empty: passed.
  std::string why;
  std::string failure;                          ///< all failures, one line; also set for an expected failure
  std::vector<AssertionResult> assertions;      ///< in the order of the criterion
  std::optional<std::size_t> failed_assertion;  ///< the first one that failed; unset if none failed
  std::int64_t last_passing_state = 0;          ///< last measured state before a failure
  std::int64_t steps = 0;                       ///< completed steps
  std::optional<std::uint64_t> state_hash;      ///< hash of the last state; unset if it was not reached
  double seconds = 0;                           ///< s, wall-clock time
};

class TestRun {
 public:
  /// `hard_case` must outlive the run. `options`: run options; the executor is taken from the configuration.
  /// `extended`: use the extended variant. `fault`: an injected fault of the criterion, or null.
  TestRun(const HardCase& hard_case, const TestConfiguration& configuration, const RunOptions& options,
          bool extended = false, const InjectedFault* fault = nullptr);
  ~TestRun();
  TestRun(TestRun&&) noexcept;

  /// Works for about this many milliseconds. Returns false when the result is known. Errors of the machine or
  /// the input are reported as failures; nothing is thrown.
  bool advance(double milliseconds);
  bool done() const;
  double progress() const;  ///< 0 to 1
  const TestResult& result() const;
  const TestConfiguration& configuration() const;
  std::int64_t bodies() const;  ///< number of bodies in the case's scene
  /// For an injected fault: true if its assertion failed as expected.
  bool fault_detected() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All configurations of a case on an executor: each solver in each precision. A rejected scene has only one,
/// because no solver runs.
std::vector<TestConfiguration> test_configurations(const HardCase& hard_case, ExecutorKind executor);
/// The configuration of an injected fault: the scene's own solver and precision, or those set by the fault.
TestConfiguration configuration_of(const HardCase& hard_case, const InjectedFault& fault,
                                   ExecutorKind executor);

/// Inputs of the HardCaseSimulation of a test. make_test_setup() throws InputError if a change is invalid for
/// the scene in this configuration.
struct TestSetup {
  Scene scene;
  RunOptions options;
  std::vector<Change> changes;
};
TestSetup make_test_setup(const HardCase& hard_case, const TestConfiguration& configuration,
                          const RunOptions& options);

/// The run at a state of a test run. Repeats the run from the start; the state is identical in every bit.
Snapshot replay_to_state(const HardCase& hard_case, const TestConfiguration& configuration,
                         const RunOptions& options, std::int64_t state);

}  // namespace collidoscope
