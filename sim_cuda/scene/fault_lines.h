#pragma once
// Lines for faults of a scene that show only after its file was read: masses that follow from densities,
// values that a flag has changed. A free function.

#include <string>
#include <vector>

#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

/// Reads the scene's file again: `file:line:column: path: message` where it has the path of a fault, else
/// `file: path: message`; the scene's name stands for a file that it lacks. Throws nothing of its own.
std::vector<std::string> fault_lines(const Scene& scene, const std::vector<Fault>& faults);

}  // namespace collidoscope
