#pragma once
// Formats the results of hard cases as text and as JSON. Stateless functions of plain data.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/stability/test_run.h"

namespace collidoscope {

struct TestRow {
  const HardCase* hard_case;
  TestConfiguration configuration;
  TestResult result;
};

struct StabilityRun {
  std::string device;
  ExecutorKind executor = ExecutorKind::cpu;  ///< cpu or cuda
  bool extended = false;                      ///< extended variants of the cases
  double seconds = 0;                         ///< wall-clock time
  std::int64_t asked = 0;  ///< number of requested test runs; greater than the number of rows if interrupted
  std::vector<TestRow> rows;  ///< ordered by group; rows of one case are adjacent

  std::int64_t count(TestOutcome outcome) const;
};

/// "penetration_chain, soft_step f32", or only the case's name if its scene is rejected.
std::string name_of(const HardCase& hard_case, const TestConfiguration& configuration);
std::string stability_json(const StabilityRun& run);
std::string stability_text(const StabilityRun& run);

/// Result of one injected fault.
struct InjectedFaultRow {
  const HardCase* hard_case;
  std::size_t fault;  ///< index in the criterion
  bool shows = false;
  TestResult result;
};
std::string injected_faults_json(const std::vector<InjectedFaultRow>& rows);
std::string injected_faults_text(const std::vector<InjectedFaultRow>& rows);

}  // namespace collidoscope
