#pragma once
// Fills what panels show of a run. Free functions.

#include <string>

#include "live/live_world.h"
#include "ui/workspace.h"

namespace collidoscope {

/// Everything that a LiveWorld knows of itself; what draws, colours and clocks are the caller's to add.
/// `view.history` points into `live`.
void fill_view(LiveWorld& live, WorkspaceView& view);

}  // namespace collidoscope
