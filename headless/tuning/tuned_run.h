#pragma once
// What the outputs of `tune` need beside the search itself: the run, its reference and the times of the
// measurements. Plain data, so that tests can invent it.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/tuning/launch_tuner.h"
#include "sim_cuda/tuning/tuning_text.h"

namespace collidoscope {

struct TunedRun {
  std::string scene, device, executor;  ///< executor: cuda or cpu
  std::string broad_phase;
  std::int64_t bodies = 0, state = 0;
  int physics_version = 0;
  LaunchShape reference;    ///< 0: automatic
  double reference_ms = 0;  ///< of a step, median
  /// Where the reference stands in the map: its own shape, or on a GPU the shape that *auto* chose for the
  /// slowest stage, with the name of this stage. Empty for *auto* on a CPU, which has no (B, T).
  std::optional<StageShape> reference_place;
  std::vector<CellTimes> cell_times;  ///< by cell; may be shorter
};
TunedRun tuned_run(World& world, const LaunchTuner& tuner);

/// "measured", "infeasible" ...
const char* name_of(LaunchCell::State state);
/// Time of a step, ms: that of the reference times the median ratio. Unlike median times, those of all cells
/// can be compared: cells with more pairs were measured in later states, too. The cell must be measured.
double typical_ms(const TunedRun& run, const LaunchCell& cell);

}  // namespace collidoscope
