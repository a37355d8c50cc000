#pragma once
// The state of an interrupted `tune` in its --json file: the same command goes on from it.

#include <nlohmann/json.hpp>
#include <string>

#include "sim_cuda/tuning/launch_tuner.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// What must be equal for the search to go on: machine, build, state of the scene, and settings.
nlohmann::ordered_json search_identity(World& world, int confirmation_pairs);

/// Members of the report of an interrupted search.
nlohmann::ordered_json progress_json(const nlohmann::ordered_json& identity, const TunerRecord& record);

/// Goes on from `file` if it has the progress of the same search, and says so on stderr. Ignores any other
/// file, which will be replaced.
void resume_search(const std::string& file, const nlohmann::ordered_json& identity, LaunchTuner& tuner);

}  // namespace collidoscope
