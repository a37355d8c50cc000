#pragma once
// Outputs of `tune --over`: the table and the JSON report.

#include <nlohmann/json.hpp>
#include <string>

#include "sim_cuda/tuning/setting_comparison.h"

namespace collidoscope {

nlohmann::ordered_json settings_json(World& world, const SettingComparison& comparison);
std::string settings_text(World& world, const SettingComparison& comparison);

}  // namespace collidoscope
