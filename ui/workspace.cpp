#include "ui/workspace.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>

#include "ui/panels.h"
#include "ui/theme.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

struct Layout {
  ScreenRect left, right, bottom, status, scene;
};

constexpr float left_ems = 21.5f, right_ems = 26;
constexpr float panel_share = 0.6f;  // maximum share of the window's width; the 3D view has the rest

float column_ems(const PanelVisibility& visible_panels) {
  return (visible_panels.left ? left_ems : 0) + (visible_panels.right ? right_ems : 0);
}

/// Default font size in pixels for a window of this size.
float usual_font_size(int width, int height) {
  const float fit = std::min(static_cast<float>(width) / 1280.0f, static_cast<float>(height) / 720.0f);
  return 13.0f * std::sqrt(std::max(fit, 1.0f));
}

Layout lay_out(const Workspace& workspace, float width, float height, float font_size) {
  const float wanted = font_size * column_ems(workspace.visible_panels), most = panel_share * width;
  const auto pixels = [&](float ems) {
    return wanted > most ? std::floor(font_size * ems * most / wanted) : std::round(font_size * ems);
  };
  const float left = workspace.visible_panels.left ? pixels(left_ems) : 0;
  const float right = workspace.visible_panels.right ? pixels(right_ems) : 0;
  const float status = std::round(font_size * 1.9f);
  float bottom = workspace.visible_panels.bottom
                     ? std::round(std::min(std::max(font_size * 13.5f, 0.22f * height), 0.4f * height))
                     : 0;
  if (bottom > 0 && workspace.has_timeline)
    bottom = std::min(bottom + timeline_strip_height(font_size), std::round(0.5f * height));
  Layout layout;
  const float body = std::max(height - status, 1.0f);
  layout.left = {0, 0, left, body};
  layout.right = {width - right, 0, right, body};
  const float middle = std::max(width - left - right, 1.0f);
  layout.bottom = {left, body - bottom, middle, bottom};
  layout.status = {0, body, width, status};
  layout.scene = {left, 0, middle, std::max(body - bottom, 1.0f)};
  return layout;
}

template <class Draw>
void window(const char* name, const ScreenRect& rect, bool scrolls, Draw draw) {
  ImGui::SetNextWindowPos({rect.x, rect.y});
  ImGui::SetNextWindowSize({rect.width, rect.height});
  ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                           ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings |
                           ImGuiWindowFlags_NoBringToFrontOnFocus;
  if (!scrolls) flags |= ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse;
  ImGui::Begin(name, nullptr, flags);
  draw();
  ImGui::End();
}

// Drawn over the 3D view and under all panels.
void draw_on_scene(const Workspace& workspace, const WorkspaceView& view) {
  ImDrawList* list = ImGui::GetBackgroundDrawList();
  const ScreenRect& at = workspace.scene_view;
  list->PushClipRect({at.x, at.y}, {at.x + at.width, at.y + at.height});
  const auto outline = [&](const std::vector<std::pair<float, float>>& around, ImU32 color) {
    if (around.size() <= 2) return;
    std::vector<ImVec2> points;
    for (const auto& [x, y] : around) points.emplace_back(x, y);
    const float size = ImGui::GetFontSize() / 14;
    list->AddPolyline(points.data(), static_cast<int>(points.size()), IM_COL32(0, 0, 0, 160),
                      ImDrawFlags_Closed, 4 * size);
    list->AddPolyline(points.data(), static_cast<int>(points.size()), color, ImDrawFlags_Closed, 2 * size);
  };
  for (const auto& around : view.frozen_outlines) outline(around, IM_COL32(120, 214, 255, 255));
  for (const WorkspaceView::FaultyPairView& pair : view.faulty_pairs) {
    constexpr ImU32 red = IM_COL32(255, 92, 82, 255);
    if (pair.a.size() <= 2 || pair.b.size() <= 2) continue;
    outline(pair.a, red);
    outline(pair.b, red);
    const auto middle = [](const std::vector<std::pair<float, float>>& around) {
      ImVec2 sum{0, 0};
      for (const auto& [x, y] : around) sum.x += x, sum.y += y;
      const auto count = static_cast<float>(around.size());
      return ImVec2{sum.x / count, sum.y / count};
    };
    const ImVec2 from = middle(pair.a), to = middle(pair.b);
    list->AddLine(from, to, red, ImGui::GetFontSize() / 7);
    constexpr std::ptrdiff_t most_labels = 8;
    if (&pair - view.faulty_pairs.data() >= most_labels) continue;
    const ImVec2 at_text{(from.x + to.x) / 2 + 4, (from.y + to.y) / 2};
    const ImVec2 size = ImGui::CalcTextSize(pair.text.c_str());
    list->AddRectFilled(at_text, {at_text.x + size.x, at_text.y + size.y}, IM_COL32(16, 18, 22, 170));
    list->AddText(at_text, IM_COL32(255, 200, 196, 255), pair.text.c_str());
  }
  outline(view.outline, IM_COL32(255, 214, 92, 255));
  float y = at.y + at.height - 0.5f * ImGui::GetFontSize();  // bottom of the next text
  const auto line = [&](const std::string& text, ImU32 color) {
    const float pad = ImGui::GetFontSize() * 0.5f, wrap = std::max(at.width - 4 * pad, 1.0f);
    const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
    const ImVec2 from{at.x + 0.5f * (at.width - size.x), y - 0.5f * ImGui::GetFontSize() - size.y};
    list->AddRectFilled({from.x - pad, from.y - 0.5f * pad},
                        {from.x + size.x + pad, from.y + size.y + 0.5f * pad}, IM_COL32(16, 18, 22, 190),
                        pad * 0.6f);
    list->AddText(nullptr, 0, from, color, text.c_str(), nullptr, wrap);
    y = from.y - 0.5f * ImGui::GetFontSize();
  };
  if (workspace.hint)
    line("Space play/pause · S step · drag orbit · wheel zoom · click select · F1 keys",
         IM_COL32(235, 238, 242, 255));
  if (!view.pairs_note.empty())
    line(view.active_settings.run.broad_phase + ": " + view.pairs_note,
         view.has_wrong_pairs ? IM_COL32(255, 120, 110, 255) : IM_COL32(235, 238, 242, 255));
  if (!workspace.notice.empty()) line(workspace.notice, IM_COL32(255, 214, 92, 255));
  list->PopClipRect();
}

}  // namespace

ScreenRect scene_view_rect(const Workspace& workspace, float width, float height, float font_size) {
  return lay_out(workspace, width, height, font_size).scene;
}

float largest_font_scale(int width, int height, float content_scale, const PanelVisibility& visible_panels) {
  const float columns = column_ems(visible_panels);
  if (columns == 0) return max_font_scale;
  const float fits = panel_share * static_cast<float>(width) / columns;
  return std::clamp(fits / (usual_font_size(width, height) * content_scale), 1.0f, max_font_scale);
}

float workspace_font_size(int width, int height, float font_scale, float content_scale,
                          const PanelVisibility& visible_panels) {
  const float scale = std::min(font_scale, largest_font_scale(width, height, content_scale, visible_panels));
  return std::round(std::clamp(usual_font_size(width, height) * content_scale * scale, 8.0f, 64.0f));
}

void draw_workspace(Workspace& workspace, const WorkspaceView& view) {
  apply_theme(workspace.theme, ImGui::GetFontSize());
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  workspace.widgets.clear();
  workspace.adjusting = workspace.adjusting_result = false;
  workspace.hovered_level = -1;
  const Layout layout = lay_out(workspace, screen.x, screen.y, ImGui::GetFontSize());
  workspace.scene_view = layout.scene;
  track(workspace, "scene", layout.scene);
  draw_on_scene(workspace, view);
  const PanelVisibility visible_panels =
      workspace.visible_panels;  // copy: a click in the status line takes effect in the next frame
  if (visible_panels.left)
    window("controls", layout.left, true, [&] {
      draw_run_panel(workspace, view);
      draw_settings_panel(workspace, view);
      draw_layers_panel(workspace, view);
      draw_camera_panel(workspace, view);
    });
  if (visible_panels.right)
    window("details", layout.right, true, [&] {
      draw_tree_panel(workspace, view);
      draw_effects_panel(workspace, view);
      draw_timing_panel(workspace, view);
      draw_launch_map_panel(workspace, view);
      draw_convergence_panel(workspace, view);
      draw_accuracy_panel(workspace, view);
      draw_hard_cases_panel(workspace, view);
      draw_break_panel(workspace, view);
      draw_numbers_panel(workspace, view);
      draw_inspector_panel(workspace, view);
    });
  if (visible_panels.bottom)
    window("graphs", layout.bottom, false, [&] {
      if (workspace.has_timeline && view.timeline) draw_timeline_strip(workspace, view);
      draw_graphs_panel(workspace, view);
    });
  window("status", layout.status, false, [&] { draw_status_line(workspace, view); });
  draw_columns_dialog(workspace);
  draw_plugin_dialog(workspace);
  draw_stop_bar(workspace, view);
  draw_error_bar(workspace);
  draw_help(workspace);
}

void end_unfinished_panels(Workspace& workspace) {
  ImGui::ErrorCheckEndFrameRecover(nullptr);
  draw_error_bar(workspace);
}

}  // namespace collidoscope
