#pragma once
// The suite `bench frames`: cost of each part of a viewer frame, measured without a window. A frame consists
// of a measured step, publishing bodies, boxes and contacts, drawing the 3D view and, with the layer `ui`,
// drawing the panels.
// glFinish separates the parts, so their times add up to the frame time. In a window the parts overlap, so a
// frame is not slower there.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError and MachineError before any file is written.
int bench_frames(const CommandLine& line);

}  // namespace collidoscope
