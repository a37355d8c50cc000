#pragma once
// Sections of the tree panel (tree_panel.cpp), drawn if the method has a tree. Free functions over the
// workspace, between ImGui::NewFrame() and Render(). Precondition: WorkspaceView::tree is not null.

#include "ui/workspace.h"

namespace collidoscope {

/// Histogram of the metric that colours the boxes. Both ends of the range can be dragged; boxes outside it
/// are not drawn.
void draw_tree_histogram(Workspace& workspace, const WorkspaceView& view);
/// One page of nodes, sorted by a metric.
void draw_tree_table(Workspace& workspace, const WorkspaceView& view);
/// The selected node, and the replay of the selected body's query.
void draw_tree_selection(Workspace& workspace, const WorkspaceView& view);

/// Side lengths of the box: "12.3 × 4 × 5.67 m".
std::string size_text(const NodeReport& node);

}  // namespace collidoscope
