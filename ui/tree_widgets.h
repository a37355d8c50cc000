#pragma once
// Widgets shared by the settings, layers and tree panels: broad phase, levels, box colours. Free functions,
// between ImGui::NewFrame() and Render().

#include "ui/workspace.h"

namespace collidoscope {

/// An invisible bar of `count` cells with the selection `first` to `last`. Dragging moves the nearer end.
/// Returns whether it is dragged. The caller draws the bar afterwards.
bool drag_ends(const char* id, float width, float height, int count, int& first, int& last);

/// Selection of the shown levels, tracked as `name`.
void draw_level_bar(Workspace& workspace, const WorkspaceView& view, const char* name);

/// Number of boxes within the shown levels and the range of the metric.
std::int64_t boxes_shown(const Workspace& workspace, const WorkspaceView& view);

/// A list of broad phases, tracked as `name` and `name.<choice>`.
void choose_broad_phase(Workspace& workspace, const WorkspaceView& view, const char* name);
/// A list of box metrics, tracked as `name` and `name.<choice>`.
void choose_box_color(Workspace& workspace, const char* name);

/// A colour bar in ascending order, with texts at both ends and in the middle.
void draw_color_bar(const std::vector<std::uint32_t>& colors, const std::string& low,
                    const std::string& title, const std::string& high);
void draw_legend(const Legend& key);

}  // namespace collidoscope
