#pragma once
// JSON form of StageLaunch, shared by all files that contain it. A free function.

#include <nlohmann/json_fwd.hpp>

#include "sim_cuda/core/stage_launch.h"

namespace collidoscope {

/// An object; null if no launch of the stage uses (B, T). Values that the executor lacks are null.
nlohmann::ordered_json launch_json(const StageLaunch& launch);

}  // namespace collidoscope
