#pragma once
// A study as plain data, and as JSON: what it is of, its reference and its points, so that one that was cut
// short goes on, and a panel or a chart can show one that was measured elsewhere. SI units; what is not known
// is null. Free functions.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/accuracy/point.h"

namespace collidoscope {

struct AccuracyRecord {
  std::string scene, executor;  ///< names
  std::string problem_hash;     ///< 16 hexadecimal digits: of all that decides points and costs
  std::int64_t bodies = 0;
  int rounds = 0;         ///< runs that each cost is the middle of, in the end
  bool complete = false;  ///< nothing is left to measure
  AccuracyReference reference;
  std::vector<AccuracyPoint> points;
  std::vector<std::string> warnings;
};

std::string write_record(const AccuracyRecord& record);
/// Throws InputError, one line that begins with `name`, where the text is no such record.
AccuracyRecord parse_record(const std::string& text, const std::string& name);

}  // namespace collidoscope
