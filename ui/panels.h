#pragma once
// The panels: one free function over the workspace per panel, in the file of its name. draw_workspace() calls
// them within an open window.

#include <string>

#include "ui/workspace.h"

namespace collidoscope {

void draw_run_panel(Workspace& workspace, const WorkspaceView& view);       ///< play, step, speed
void draw_settings_panel(Workspace& workspace, const WorkspaceView& view);  ///< settings of the run
void draw_layers_panel(Workspace& workspace,
                       const WorkspaceView& view);  ///< visible layers and their colours
void draw_camera_panel(Workspace& workspace, const WorkspaceView& view);  ///< views, theme, picture, keys
void draw_effects_panel(Workspace& workspace,
                        const WorkspaceView& view);                       ///< effects and their costs
void draw_timing_panel(Workspace& workspace, const WorkspaceView& view);  ///< table of stage times
void draw_convergence_panel(Workspace& workspace,
                            const WorkspaceView& view);                       ///< residuals of the solver
void draw_launch_map_panel(Workspace& workspace, const WorkspaceView& view);  ///< time over B and T
void draw_accuracy_panel(Workspace& workspace, const WorkspaceView& view);  ///< error versus cost of settings
void draw_hard_cases_panel(Workspace& workspace, const WorkspaceView& view);  ///< results of the hard cases
void draw_break_panel(Workspace& workspace, const WorkspaceView& view);       ///< break conditions
void draw_numbers_panel(Workspace& workspace, const WorkspaceView& view);     ///< counts, energy, momentum
void draw_tree_panel(Workspace& workspace,
                     const WorkspaceView& view);  ///< quality of the tree, worst nodes, query
void draw_inspector_panel(Workspace& workspace, const WorkspaceView& view);  ///< the selected body
void draw_graphs_panel(Workspace& workspace,
                       const WorkspaceView& view);  ///< plots over time, in the bottom strip
/// The choice of columns, over the 3D view.
void draw_columns_dialog(Workspace& workspace);
void draw_plugin_dialog(Workspace& workspace);
void draw_timeline_strip(Workspace& workspace,
                         const WorkspaceView& view);  ///< the whole run, over the graphs
float timeline_strip_height(float font_size);
void draw_status_line(Workspace& workspace, const WorkspaceView& view);
void draw_stop_bar(Workspace& workspace,
                   const WorkspaceView& view);  ///< stop line, in its own window over the 3D view
void draw_error_bar(Workspace& workspace);      ///< error line, in its own window over the 3D view
void draw_help(Workspace& workspace);           ///< list of keys, in its own window over the 3D view

/// "60 generated - 2 removed + 3 others = 61"; empty if all bodies are generated.
std::string bodies_text(const WorkspaceView& view);

}  // namespace collidoscope
