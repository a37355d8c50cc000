#pragma once
// `bench frames`: what each part of a live frame costs, without a window. A frame is what the viewer does: a
// step, measured; its bodies, boxes and contacts published; the 3D view drawn; and with the layer `ui` the
// panels around it. The GPU finishes each part before the next begins (glFinish), so parts add up to the
// frame, and a window, where they overlap, is no slower.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError and MachineError; nothing is written then.
int bench_frames(const CommandLine& line);

}  // namespace collidoscope
