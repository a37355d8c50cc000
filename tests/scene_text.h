#pragma once
// The text of scene files in tests.

#include <string>
#include <vector>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

/// The first line of a scene. The text after it begins on line 2.
inline const std::string scene_head = "{\"format\": \"collidoscope-scene\", \"version\": 1,\n";

/// The faults of the text as a file named "s"; empty for a valid scene.
inline std::vector<std::string> scene_faults_of(const std::string& text) {
  try {
    parse_scene(text, "s");
  } catch (const InputError& error) {
    return error.lines();
  }
  return {};
}

}  // namespace collidoscope
