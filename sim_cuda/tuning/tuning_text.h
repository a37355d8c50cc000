#pragma once
// Texts about launch shapes, the same in the command and in the window. Free functions.

#include <string>

#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/tuning/launch_search.h"

namespace collidoscope {

/// "auto", or "B = 264, T = 128".
std::string shape_text(LaunchShape shape);
/// Value of --stage-shapes: "solve=264x128,relax=528x64".
std::string stage_shapes_text(const StageShapes& shapes);
/// The chosen shape over the reference, and whether it is worth a setting. One line.
std::string verdict_line(const LaunchSearch& search, LaunchShape reference);

}  // namespace collidoscope
