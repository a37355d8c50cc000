#pragma once
// What the test runs of hard cases came to, for people and as JSON. Free functions over plain data.

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
  bool extended = false;                      ///< the long variants
  double seconds = 0;                         ///< of the clock
  std::int64_t asked = 0;                     ///< test runs; more than there are rows: it was stopped
  std::vector<TestRow> rows;                  ///< of one case beside each other, by group

  std::int64_t count(TestOutcome outcome) const;
};

/// "penetration_chain, soft_step f32", or the name of the case alone, whose scene is refused.
std::string name_of(const HardCase& hard_case, const TestConfiguration& configuration);
std::string stability_json(const StabilityRun& run);
std::string stability_text(const StabilityRun& run);

/// One of the faults that were injected.
struct InjectedFaultRow {
  const HardCase* hard_case;
  std::size_t fault;  ///< its place in the criterion
  bool shows = false;
  TestResult result;
};
std::string injected_faults_json(const std::vector<InjectedFaultRow>& rows);
std::string injected_faults_text(const std::vector<InjectedFaultRow>& rows);

}  // namespace collidoscope
