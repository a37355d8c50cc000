#pragma once
// A test run: one hard case, with one solver, in one precision, on one executor, run to its last state or to
// the first at which an assertion does not hold. Made in slices, so that somebody can draw in between. Not
// thread-safe; test runs side by side share nothing.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "sim_cuda/stability/hard_case.h"

namespace collidoscope {

/// Which of a case's test runs.
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

/// What came of one assertion: its value nearest to a bound, or, where it did not hold, the first beyond it.
struct AssertionResult {
  bool measured = false, passed = true;
  double value = 0, bound = 0;
  std::int64_t state = 0;
  std::optional<std::uint32_t> body;
};

struct TestResult {
  TestOutcome outcome = TestOutcome::passed;
  /// A line: what failed; or the reason of the declared limit; or why it does not apply. Empty: passed.
  std::string why;
  std::string failure;                      ///< the same of a declared limit: what failed there
  std::vector<AssertionResult> assertions;  ///< as they stand in the criterion
  std::optional<std::size_t>
      failed_assertion;                     ///< unset where nothing failed, or what failed is no assertion
  std::int64_t last_passing_state = 0;      ///< the last state that was measured before
  std::int64_t steps = 0;                   ///< made
  std::optional<std::uint64_t> state_hash;  ///< of the last state; unset: it did not come to one
  double seconds = 0;                       ///< of the clock
};

class TestRun {
 public:
  /// `hard_case` outlives it. `options`: what it runs on, the executor aside; `extended`: its long variant;
  /// `fault`: one of the criterion's, injected in this run.
  TestRun(const HardCase& hard_case, const TestConfiguration& configuration, const RunOptions& options,
          bool extended = false, const InjectedFault* fault = nullptr);
  ~TestRun();
  TestRun(TestRun&&) noexcept;

  /// Works for about so long; false once the result is known. What the machine or the input refuses on the
  /// way is the test run's failure; nothing is thrown.
  bool advance(double milliseconds);
  bool done() const;
  double progress() const;  ///< 0 to 1
  const TestResult& result() const;
  const TestConfiguration& configuration() const;
  std::int64_t bodies() const;  ///< of the case's scene
  /// Of a fault: whether the assertion that it is to fail did not hold.
  bool fault_detected() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All test runs of a case on an executor: each solver in each precision; of a scene that is refused, which
/// happens before there is a solver, one.
std::vector<TestConfiguration> test_configurations(const HardCase& hard_case, ExecutorKind executor);
/// Of a fault: the scene's own solver and precision, or those that the fault sets.
TestConfiguration configuration_of(const HardCase& hard_case, const InjectedFault& fault,
                                   ExecutorKind executor);

/// What the run of a test is made of, as a HardCaseSimulation takes it. Throws InputError where the changes
/// are not such as the scene takes in this setting.
struct TestSetup {
  Scene scene;
  RunOptions options;
  std::vector<Change> changes;
};
TestSetup make_test_setup(const HardCase& hard_case, const TestConfiguration& configuration,
                          const RunOptions& options);

/// The run as it stood at a state of a test run: made again from the start, so the same bit for bit.
Snapshot replay_to_state(const HardCase& hard_case, const TestConfiguration& configuration,
                         const RunOptions& options, std::int64_t state);

}  // namespace collidoscope
