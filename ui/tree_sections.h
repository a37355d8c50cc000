#pragma once
// The parts of the panel of the tree (tree_panel.cpp), for trees that there are. Free functions over the
// workspace, between ImGui::NewFrame() and Render(); WorkspaceView::tree is not null.

#include "ui/workspace.h"

namespace collidoscope {

/// How the metric that colours the boxes spreads. Both ends of its range are dragged; what lies outside is
/// not drawn.
void draw_tree_histogram(Workspace& workspace, const WorkspaceView& view);
/// The worst nodes, a page of them, by any metric.
void draw_tree_table(Workspace& workspace, const WorkspaceView& view);
/// The selected node, and step by step what the selected body's query visits.
void draw_tree_selection(Workspace& workspace, const WorkspaceView& view);

/// "12.3 × 4 × 5.67 m".
std::string size_text(const NodeReport& node);

}  // namespace collidoscope
