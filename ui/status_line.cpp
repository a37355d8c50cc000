#include <fmt/format.h>
#include <imgui.h>

#include <tuple>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {

void draw_status_line(Workspace& workspace, const WorkspaceView& view) {
  struct PanelToggle {
    const char *name, *label;
    bool& open;
  };
  const PanelToggle visible_panels[] = {{"fold.left", "controls", workspace.visible_panels.left},
                                        {"fold.bottom", "graphs", workspace.visible_panels.bottom},
                                        {"fold.right", "details", workspace.visible_panels.right}};
  for (const PanelToggle& toggle : visible_panels) {
    const bool on = toggle.open;
    if (!on) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    if (ImGui::SmallButton(toggle.label)) toggle.open = !toggle.open;
    if (!on) ImGui::PopStyleColor();
    track(workspace, toggle.name);
    explain(on ? "Hides these panels" : "Shows these panels");
    ImGui::SameLine();
  }
  const std::string text =
      fmt::format(" {} on {} · renderer: {}{} · display path: {}", view.executor, view.device, view.renderer,
                  !view.software ? ""
                  : view.view_scale == 1.0
                      ? " (software)"
                      : fmt::format(" (software; {:.0f} % resolution in motion)", 100 * view.view_scale),
                  view.display_path);
  // The buttons are anchored in the corner, so that they stay under the pointer when the font grows.
  const ImVec2 padding = ImGui::GetStyle().WindowPadding;
  const float gap = ImGui::GetStyle().ItemSpacing.x, right = ImGui::GetWindowWidth() - padding.x;
  const auto width = [](const char* label) {
    return ImGui::CalcTextSize(label).x + 2 * ImGui::GetStyle().FramePadding.x;
  };
  const float left = right - width("A−") - width("A+") - gap;
  const ImVec2 at = ImGui::GetWindowPos();
  ImGui::PushClipRect(at, {at.x + left - gap, at.y + ImGui::GetWindowHeight()}, true);
  faint_text(text);
  ImGui::PopClipRect();
  for (const auto& [name, label, factor, help] :
       {std::tuple{"view.smaller", "A−", 1 / 1.1f, "Smaller text: Ctrl −"},
        std::tuple{"view.larger", "A+", 1.1f,
                   "Larger text: Ctrl +. The limit leaves the 3D view 40 % of the width; hide a column to "
                   "raise it"}}) {
    const bool larger = factor > 1;
    ImGui::SameLine(larger ? right - width(label) : left);
    ImGui::BeginDisabled(larger ? workspace.font_scale >= workspace.largest_font_scale
                                : workspace.font_scale <= min_font_scale);
    if (ImGui::SmallButton(label)) workspace.scale_font(factor);
    ImGui::EndDisabled();
    track(workspace, name);
    explain(help);
  }
}

void draw_error_bar(Workspace& workspace) {
  if (workspace.errors.empty()) return;
  const ScreenRect& at = workspace.scene_view;
  const float margin = ImGui::GetFontSize();
  ImGui::SetNextWindowPos({at.x + margin, at.y + margin});
  ImGui::SetNextWindowSize({std::max(at.width - 2 * margin, 100.0f), 0});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, ImVec4(0.48f, 0.12f, 0.10f, 0.97f));
  ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 1, 1, 1));
  ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0.7f, 0.28f, 0.25f, 1));
  ImGui::Begin("error", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(workspace.errors.front().c_str());
  ImGui::PopTextWrapPos();
  const bool dismissed = ImGui::Button("Dismiss");
  track(workspace, "error.dismiss");
  if (workspace.errors.size() > 1) {
    ImGui::SameLine();
    ImGui::TextUnformatted(fmt::format("and {} more", workspace.errors.size() - 1).c_str());
  }
  ImGui::End();
  ImGui::PopStyleColor(3);
  if (dismissed) workspace.errors.erase(workspace.errors.begin());
}

void draw_help(Workspace& workspace) {
  if (!workspace.help) return;
  static constexpr const char* keys[][2] = {
      {"Space", "play, pause"},
      {"Shift Space", "play backwards"},
      {"S", "one step"},
      {"Shift S", "one step back"},
      {"[  ]", "the mark before, after"},
      {"Ctrl S", "write the run to captures/"},
      {"R", "restart"},
      {"drag", "orbit about the target"},
      {"right drag", "pan"},
      {"wheel", "zoom to the pointer"},
      {"W A S D Q E, right button held", "fly"},
      {"F", "frame the selection, or all bodies"},
      {"Shift F", "frame all bodies"},
      {"1  3  7", "front, side, top view"},
      {"5", "toggle perspective"},
      {"click", "select a body, or a box while Tree is open; on nothing: deselect"},
      {"Escape", "cancel long work; deselect"},
      {"B", "throw a ball from the camera"},
      {"Delete", "delete the selected body"},
      {"C", "panel Convergence"},
      {"P", "write a picture of the window to captures/"},
      {"Tab", "hide or show all panels"},
      {"Ctrl +  Ctrl -  Ctrl 0", "larger, smaller, default text"},
      {"F1", "this list"}};
  const ScreenRect& at = workspace.scene_view;
  ImGui::SetNextWindowPos({at.x + 0.5f * at.width, at.y + 0.5f * at.height}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::Begin("Keys", &workspace.help,
               ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove);
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const auto& [key, action] : keys) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(key);
      ImGui::TableNextColumn();
      faint_text(action);
    }
    ImGui::EndTable();
  }
  ImGui::End();
}

}  // namespace collidoscope
