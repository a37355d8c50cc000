#pragma once
// An accuracy study as plain data and as JSON: problem, reference and points. An interrupted study can be
// resumed from it, and panels and charts can show studies of other machines. SI units; null for unknown
// values. Stateless functions.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/core/physics_version.h"

namespace collidoscope {

struct AccuracyRecord {
  std::string scene, executor;  ///< names
  std::string problem_hash;     ///< 16 hexadecimal digits: hash of all inputs that affect points and costs
  std::int64_t bodies = 0;
  int rounds = 0;         ///< number of runs per cost in the complete study
  bool complete = false;  ///< all measurements are done
  AccuracyReference reference;
  std::vector<AccuracyPoint> points;
  std::vector<std::string> warnings;
  int physics_version = collidoscope::physics_version;  ///< of the program that measured it
};

std::string write_record(const AccuracyRecord& record);
/// Parses a record. Throws InputError with one line that begins with `name` if the text is not a valid
/// record.
AccuracyRecord parse_record(const std::string& text, const std::string& name);

}  // namespace collidoscope
