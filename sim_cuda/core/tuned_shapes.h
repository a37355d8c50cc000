#pragma once
// Launch shapes that an earlier measurement found to be faster than *auto*, and the conditions of that
// measurement. *auto* uses them where the conditions are the same. Plain data. No shape changes the state.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/core/ratio_estimate.h"

namespace collidoscope {

/// What the fastest shape depends on.
struct TuningConditions {
  std::string device;   ///< ComputeDevice::name
  std::string driver;   ///< ComputeDevice::driver
  std::string build;    ///< build_name()
  int cpu_threads = 0;  ///< 0 on a GPU
  std::string broad_phase, solver, precision;
  std::vector<std::string> effects;
  std::int64_t bodies = 0;
  std::string scene;  ///< name; results of the same scene are preferred
  friend bool operator==(const TuningConditions&, const TuningConditions&) = default;
};

struct TunedShapes {
  TuningConditions conditions;
  std::string data;   ///< file of the measurement, or empty
  LaunchShape shape;  ///< of all stages without an own shape; 0: automatic
  StageShapes stages;
  RatioEstimate ratio{.low = 1, .high = 1};  ///< time over that of plain *auto*
  bool named_by_user =
      false;  ///< the user named its file, so that it is rejected with a reason on any device
};
/// "Gas with 10000 bodies: 2.7 % ± 0.4 faster than plain auto, 41 pairs".
std::string tuned_text(const TunedShapes& result);

/// Which result *auto* uses.
struct TunedChoice {
  const TunedShapes* used = nullptr;
  /// If none is used: why not the nearest one. Empty: there is none for this device.
  std::string rejection;
};

/// Results for half to twice as many bodies count, those of the same scene first, then the nearest. All other
/// conditions must be equal. If that result is that plain *auto* is as fast, none is used.
TunedChoice choose_tuned(const std::vector<TunedShapes>& results, const TuningConditions& now);

/// Compiler and physics version: "nvcc 13.0, physics 9". Other versions may have other kernels.
std::string build_name(bool on_gpu);

}  // namespace collidoscope
