#pragma once
// StageLaunch as JSON, the same in all files that say it. A free function.

#include <nlohmann/json_fwd.hpp>

#include "sim_cuda/core/stage_launch.h"

namespace collidoscope {

/// An object; null where nothing of the stage obeys (B, T). What the executor does not have is null.
nlohmann::ordered_json launch_json(const StageLaunch& launch);

}  // namespace collidoscope
