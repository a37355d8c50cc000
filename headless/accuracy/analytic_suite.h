#pragma once
// The command `accuracy` without a scene: the analytic suite (sim_cuda/reference/analytic_cases.h). Each case
// runs with its integrators, in double and in float, at four steps. Prints a table on stdout and writes JSON,
// CSV, Markdown and a chart on request.

#include <string>
#include <vector>

#include "headless/cli/command_line.h"
#include "sim_cuda/reference/analytic_case.h"
#include "ui/chart.h"

namespace collidoscope {

/// Returns the exit status: 1 if a case fails. --integrator and --precision select rows; other scene flags
/// are rejected. Throws InputError or MachineError before any file is written.
int analytic_suite(const CommandLine& line);

/// Formatted results of the suite. `results` must be in run order, with the results of one case and
/// integrator adjacent.
std::string analytic_json(const std::vector<AnalyticResult>& results, const std::string& device);
std::string analytic_csv(const std::vector<AnalyticResult>& results);
std::string analytic_markdown(const std::vector<AnalyticResult>& results, const std::string& device);
std::string analytic_text(const std::vector<AnalyticResult>& results, const std::string& device);
/// Chart of one case: error over step, one line per integrator and precision. The slope is the order. The
/// float line departs from the double line where rounding dominates.
Chart analytic_chart(const std::vector<AnalyticResult>& results, const std::string& name);

}  // namespace collidoscope
