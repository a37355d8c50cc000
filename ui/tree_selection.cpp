#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "ui/tree_sections.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

// Legend entry of a mark.
void key(const WorkspaceView& view, BoxMark mark, const char* text) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float size = ImGui::GetFontSize();
  const auto kind = static_cast<std::size_t>(mark);
  const ImU32 color = kind < view.mark_colors.size() ? view.mark_colors[kind] : 0xffa0a0a0u;
  ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + 0.3f * size},
                                            {at.x + 0.55f * size, at.y + 0.85f * size}, color, 2);
  ImGui::Dummy({0.95f * size, size});
  ImGui::SameLine(0, 0);
  faint_text(text);
}

void draw_node(Workspace& workspace, const WorkspaceView& view) {
  const TreePanelView& panel = *view.tree;
  if (!panel.node) return;
  key(view, BoxMark::node, fmt::format("node {}, level {}", panel.node->node, panel.node->level).c_str());
  ImGui::SameLine();
  key(view, BoxMark::left, "");
  ImGui::SameLine(0, 0);
  key(view, BoxMark::right, "children");
  ImGui::SameLine();
  if (ImGui::SmallButton("frame")) workspace.camera_request = CameraRequest::frame_selection;
  track(workspace, "tree.frame");
  explain("F: frames the node");
  faint_text(size_text(*panel.node));
}

void draw_query(Workspace& workspace, const WorkspaceView& view) {
  const TreePanelView& panel = *view.tree;
  TreeRequests& requests = workspace.tree;
  ImGui::Checkbox("query of the selected body", &requests.query);
  track(workspace, "tree.query");
  explain("Shows the boxes that the query tests, in order from the root, in place of the path");
  if (!requests.query) return;
  if (!workspace.selection || panel.visited.empty()) {
    faint_text("click a body, or a leaf in the table");
    return;
  }
  const auto count = static_cast<int>(panel.visited.size());
  if (requests.playing) {
    // Replay rate: at most five seconds in total, at least five visits per second.
    const double more = static_cast<double>(ImGui::GetIO().DeltaTime) * std::max(5.0, count / 5.0);
    requests.visit = std::min(requests.visit + more, static_cast<double>(count));
    if (requests.visit >= count) requests.playing = false;
  }
  int at = std::clamp(static_cast<int>(requests.visit), 1, count);
  if (ImGui::Button(requests.playing ? "pause" : "play ")) {
    requests.playing = !requests.playing;
    if (requests.playing && at == count) requests.visit = 1;
  }
  track(workspace, "tree.query.play");
  ImGui::SameLine();
  for (const auto& [name, label, by] :
       {std::tuple{"tree.query.back", "<", -1}, std::tuple{"tree.query.on", ">", 1}}) {
    if (ImGui::Button(label)) requests.visit = std::clamp(at + by, 1, count);
    track(workspace, name);
    ImGui::SameLine();
  }
  ImGui::SetNextItemWidth(-1);
  at = std::clamp(static_cast<int>(requests.visit), 1, count);
  if (ImGui::SliderInt("##visit", &at, 1, count, "visit %d",
                       ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput))
    requests.visit = at;
  track(workspace, "tree.query.at");
  const TreePanelView::Visited& visited = panel.visited[static_cast<std::size_t>(at) - 1];
  const NodeReport& node = visited.node;
  key(view, visited.met ? BoxMark::met : BoxMark::apart,
      fmt::format("{} of {}: {}, level {}: {}", at, grouped_number(panel.visits),
                  node.children > 0 ? fmt::format("node {}", node.node) : fmt::format("body {}", node.body),
                  node.level,
                  !visited.met                        ? "no overlap"
                  : node.children > 0                 ? "overlap, descend"
                  : node.body == *workspace.selection ? "itself"
                                                      : "pair")
          .c_str());
  if (panel.visits > count) faint_text(fmt::format("only the first {} are stored", grouped_number(count)));
}

}  // namespace

void draw_tree_selection(Workspace& workspace, const WorkspaceView& view) {
  ImGui::PushID("selection");  // distinct from the buttons of the table
  draw_node(workspace, view);
  draw_query(workspace, view);
  ImGui::PopID();
}

}  // namespace collidoscope
