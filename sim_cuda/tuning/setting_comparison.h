#pragma once
// Compares values of one setting after the other with the present ones, by PairedSteps (`tune --over`). Some
// settings keep the state bit for bit; the others change the result, and their error comes from an
// AccuracyStudy.

#include <functional>
#include <string>
#include <vector>

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/core/ratio_estimate.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// One value of one setting; all others are the present ones.
struct SettingChoice {
  std::string axis, value;  ///< as a flag: "broad-phase", "ploc"
  Scene scene;
  RunOptions options;
  bool keeps_result = true;
};

/// Names of settings that can be compared.
std::vector<std::string> comparison_axes();
/// The choices of these axes, without the present values.
std::vector<SettingChoice> setting_choices(const World& world, const std::vector<std::string>& axes);

struct ComparedSetting {
  std::string axis, value;
  bool keeps_result = true;
  double ms = not_known;           ///< of a step: that of the reference times the median ratio
  RatioEstimate estimate;          ///< time over that of the reference
  double error = not_known;        ///< m, as AccuracyPoint::error; of settings that change the result
  std::string unavailable_reason;  ///< why it was not measured; empty: it was
  std::string difference;          ///< how the state differs although it must not; empty: it does not
};

struct SettingComparison {
  double reference_ms = not_known;
  double reference_error = not_known;   ///< m, of the present settings; known if an axis changes the result
  double error_resolution = not_known;  ///< m, error of the study's own reference
  std::string error_unavailable;        ///< why errors are not known; empty: they are, or none is needed
  std::vector<ComparedSetting> rows;    ///< by choice
  double seconds = 0;
};

/// `budget`: s, of all measurements together; each choice gets six pairs even beyond it. The world is only
/// read. `progress` gets the finished share, 0 to 1. Throws as World does.
SettingComparison compare_settings(World& world, const std::vector<SettingChoice>& choices, double budget,
                                   const std::function<void(double)>& progress);

}  // namespace collidoscope
