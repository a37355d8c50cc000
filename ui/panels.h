#pragma once
// The panels: each a free function over the workspace, in the file of its name. Drawn by draw_workspace(),
// each within a window that is open.

#include <string>

#include "ui/workspace.h"

namespace collidoscope {

void draw_run_panel(Workspace& workspace, const WorkspaceView& view);       ///< play, step, speed
void draw_settings_panel(Workspace& workspace, const WorkspaceView& view);  ///< (N, B, T) and their kin
void draw_layers_panel(Workspace& workspace, const WorkspaceView& view);  ///< what is shown, and its colours
void draw_camera_panel(Workspace& workspace, const WorkspaceView& view);  ///< views, theme, size of text
void draw_effects_panel(Workspace& workspace,
                        const WorkspaceView& view);                       ///< what is on, and what each costs
void draw_timing_panel(Workspace& workspace, const WorkspaceView& view);  ///< the table of stages
void draw_convergence_panel(Workspace& workspace,
                            const WorkspaceView& view);  ///< what sweeps of the solver leave
void draw_accuracy_panel(Workspace& workspace, const WorkspaceView& view);  ///< error over price of settings
void draw_hard_cases_panel(Workspace& workspace, const WorkspaceView& view);  ///< what holds of hard cases
void draw_break_panel(Workspace& workspace, const WorkspaceView& view);       ///< where the run is to stop
void draw_numbers_panel(Workspace& workspace, const WorkspaceView& view);     ///< counts, energy, momentum
void draw_tree_panel(Workspace& workspace,
                     const WorkspaceView& view);  ///< how good the tree is, and where not
void draw_inspector_panel(Workspace& workspace, const WorkspaceView& view);  ///< the selected body
void draw_graphs_panel(Workspace& workspace, const WorkspaceView& view);     ///< over time, along the bottom
void draw_status_line(Workspace& workspace, const WorkspaceView& view);
void draw_stop_bar(
    Workspace& workspace,
    const WorkspaceView& view);  ///< at what it has stopped; in a window of its own, over the 3D view
void draw_error_bar(Workspace& workspace);  ///< in a window of its own, over the 3D view
void draw_help(Workspace& workspace);       ///< the keys; so too

/// How N and what was removed and added make up the bodies that there are; empty: N is all of them.
std::string bodies_text(const WorkspaceView& view);

}  // namespace collidoscope
