#pragma once
// Formats faults that are found after the scene file was read, such as masses computed from densities or
// values set by a flag. Stateless.

#include <string>
#include <vector>

#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

/// Formats each fault as `file:line:column: path: message` if its path is in the scene's file, otherwise as
/// `file: path: message`. Uses the scene's name if there is no file.
/// Reads the scene's file again. An unreadable file is not an error.
std::vector<std::string> fault_lines(const Scene& scene, const std::vector<Fault>& faults);

}  // namespace collidoscope
