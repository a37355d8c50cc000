#pragma once
// Fills a WorkspaceView from a run. A free function.

#include "ui/workspace.h"
#include "viewer/session/live_world.h"

namespace collidoscope {

/// Sets the values that a World provides without arranging its tree. The caller adds level sizes, renderer,
/// colours, clocks and `edited`. `stats`: those of the current state. `view.history` points to `history`.
void fill_view(World& world, const StepStats& stats, const History& history, WorkspaceView& view);

}  // namespace collidoscope
