#pragma once
// What the trials of hard cases came to, for people and as JSON. Free functions over plain data.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/stability/trial.h"

namespace collidoscope {

struct TrialRow {
  const HardCase* one;
  TrialSetting setting;
  TrialResult result;
};

struct StabilityRun {
  std::string device;
  ExecutorKind executor = ExecutorKind::cpu;  ///< cpu or cuda
  bool extended = false;                      ///< the long variants
  double seconds = 0;                         ///< of the clock
  std::int64_t asked = 0;                     ///< trials; more than there are rows: it was stopped
  std::vector<TrialRow> rows;                 ///< of one case beside each other, by group

  std::int64_t count(Verdict verdict) const;
};

/// "penetration_chain, soft_step f32", or the name of the case alone, whose scene is refused.
std::string name_of(const HardCase& one, const TrialSetting& setting);
std::string stability_json(const StabilityRun& run);
std::string stability_text(const StabilityRun& run);

/// One of the faults that were planted.
struct PlantedRow {
  const HardCase* one;
  std::size_t fault;  ///< its place in the criterion
  bool shows = false;
  TrialResult result;
};
std::string planted_json(const std::vector<PlantedRow>& rows);
std::string planted_text(const std::vector<PlantedRow>& rows);

}  // namespace collidoscope
