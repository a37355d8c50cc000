#pragma once
// Fills what panels show of a run. A free function.

#include "ui/workspace.h"
#include "viewer/session/live_world.h"

namespace collidoscope {

/// What a World knows of itself without asking its tree; level sizes, what draws, colours, clocks and
/// `edited` are the caller's to add. `stats`: of the current state. `view.history` points to `history`.
void fill_view(World& world, const StepStats& stats, const History& history, WorkspaceView& view);

}  // namespace collidoscope
