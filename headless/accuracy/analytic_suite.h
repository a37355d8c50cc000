#pragma once
// `accuracy` without a scene: every case of the analytic suite (sim_cuda/reference/analytic_cases.h), with
// each integrator that it is about, in double and in float, at four steps each; a table on stdout, and JSON,
// CSV, Markdown and a chart where flags ask for them.

#include <string>
#include <vector>

#include "headless/cli/command_line.h"
#include "sim_cuda/reference/analytic_case.h"
#include "ui/chart.h"

namespace collidoscope {

/// The exit status: 1 where a case fails. --integrator and --precision choose among the rows; other flags of
/// the scene are refused. Throws InputError or MachineError, and has written nothing then.
int analytic_suite(const CommandLine& line);

/// What the suite came to, as files and for people. Results of one case and integrator follow each other, and
/// cases stand in the order in which they ran.
std::string analytic_json(const std::vector<AnalyticResult>& results, const std::string& device);
std::string analytic_csv(const std::vector<AnalyticResult>& results);
std::string analytic_markdown(const std::vector<AnalyticResult>& results, const std::string& device);
std::string analytic_text(const std::vector<AnalyticResult>& results, const std::string& device);
/// One case, error over step, a line for each integrator and precision: orders are slopes, and float ends
/// where it turns away from double.
Chart analytic_chart(const std::vector<AnalyticResult>& results, const std::string& name);

}  // namespace collidoscope
