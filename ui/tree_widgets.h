#pragma once
// What the panels of settings, layers and the tree share: how pairs are found, which levels are shown, and
// what colours the boxes. Free functions, between ImGui::NewFrame() and Render().

#include "ui/workspace.h"

namespace collidoscope {

/// An invisible bar of `count` cells, of which first to last are chosen; whichever end is nearer to the
/// pointer follows it. Returns whether it is dragged. The next widget is drawn below it.
bool drag_ends(const char* id, float width, float height, int count, int& first, int& last);

/// The levels that are shown, tracked as `name`.
void draw_level_bar(Workspace& workspace, const WorkspaceView& view, const char* name);

/// Boxes that are drawn, where they are, by level and by the range of what colours them.
std::int64_t boxes_shown(const Workspace& workspace, const WorkspaceView& view);

/// A list of broad phases, tracked as `name` and `name.<choice>`.
void choose_broad_phase(Workspace& workspace, const WorkspaceView& view, const char* name);
/// A list of what can colour the boxes, tracked as `name` and `name.<choice>`.
void choose_box_color(Workspace& workspace, const char* name);

/// A bar of colours from least to greatest, with what stands at its ends and in its middle.
void draw_color_bar(const std::vector<std::uint32_t>& colors, const std::string& low,
                    const std::string& title, const std::string& high);
void draw_legend(const Legend& key);

}  // namespace collidoscope
