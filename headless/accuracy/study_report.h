#pragma once
// What a study of accuracy has found, for people and for spreadsheets. Free functions over a record.

#include <optional>
#include <string>

#include "sim_cuda/accuracy/record.h"
#include "ui/chart.h"

namespace collidoscope {

/// Tables by series, what is cheapest below a tolerance in m, and where float stops paying.
std::string study_text(const AccuracyRecord& record, std::optional<double> tolerance);
/// A row for each setting.
std::string study_csv(const AccuracyRecord& record);
/// The front, as a table.
std::string study_markdown(const AccuracyRecord& record, std::optional<double> tolerance);
/// The work-precision diagram as a picture of its own, with what it is of.
Chart study_chart(const AccuracyRecord& record, std::optional<double> tolerance);

}  // namespace collidoscope
