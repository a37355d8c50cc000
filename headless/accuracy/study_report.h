#pragma once
// Formats the results of an accuracy study for terminals and spreadsheets. Stateless functions of a record.

#include <optional>
#include <string>

#include "sim_cuda/accuracy/record.h"
#include "ui/chart.h"

namespace collidoscope {

/// Tables by series, the cheapest setting below the tolerance in m, and the step below which float is
/// inaccurate.
std::string study_text(const AccuracyRecord& record, std::optional<double> tolerance);
/// One row per setting.
std::string study_csv(const AccuracyRecord& record);
/// The Pareto front as a table.
std::string study_markdown(const AccuracyRecord& record, std::optional<double> tolerance);
/// The work-precision diagram as a chart with title and axes.
Chart study_chart(const AccuracyRecord& record, std::optional<double> tolerance);

}  // namespace collidoscope
