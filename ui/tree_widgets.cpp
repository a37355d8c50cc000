#include "ui/tree_widgets.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ui/widgets.h"

namespace collidoscope {

namespace {

/// Whether white text is more legible than black text on this colour over the window.
bool is_dark(ImU32 color) {
  const ImVec4 c = ImGui::ColorConvertU32ToFloat4(color), under = ImGui::GetStyleColorVec4(ImGuiCol_WindowBg);
  const auto mixed = [&](float over, float below) { return c.w * over + (1 - c.w) * below; };
  return 0.30f * mixed(c.x, under.x) + 0.59f * mixed(c.y, under.y) + 0.11f * mixed(c.z, under.z) < 0.42f;
}

}  // namespace

bool drag_ends(const char* id, float width, float height, int count, int& first, int& last) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton(id, {width, height});
  if (!ImGui::IsItemActive()) return false;
  const float cell = width / static_cast<float>(count);
  const int under = std::clamp(static_cast<int>((ImGui::GetIO().MousePos.x - at.x) / cell), 0, count - 1);
  ImGuiStorage* memory = ImGui::GetStateStorage();
  const ImGuiID which = ImGui::GetID((std::string(id) + " end").c_str());
  if (ImGui::IsItemActivated())
    memory->SetInt(which, std::abs(under - first) < std::abs(under - last) || under < first ? 0 : 1);
  if (memory->GetInt(which) == 0)
    first = std::min(under, last);
  else
    last = std::max(under, first);
  return true;
}

void draw_level_bar(Workspace& workspace, const WorkspaceView& view, const char* name) {
  const int count = static_cast<int>(view.level_sizes.size());
  if (count == 0) {
    faint_text("this method has no tree");
    return;
  }
  FrameLayers& layers = workspace.layers;
  int first = std::clamp(layers.first_level, 0, count - 1),
      last = std::clamp(layers.last_level, first, count - 1);
  const float height = ImGui::GetFontSize() * 1.3f, width = ImGui::GetContentRegionAvail().x;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float cell = width / static_cast<float>(count);
  if (drag_ends("levels", width, height, count, first, last)) {
    workspace.levels_chosen = true;
    layers.first_level = first;
    layers.last_level = last == count - 1 ? 63 : last;  // keeps "to the leaves" when the tree grows
  }
  track(workspace, name);
  const bool inside = ImGui::IsItemHovered() || ImGui::IsItemActive();
  const int under =
      inside ? std::clamp(static_cast<int>((ImGui::GetIO().MousePos.x - at.x) / cell), 0, count - 1) : -1;
  if (layers.boxes && under >= first && under <= last) workspace.hovered_level = under;
  explain(count < 64 ? "Shown levels of the tree; 0 is the root. Drag an end"
                     : "Shown levels of the tree; 0 is the root, 63 includes all deeper boxes. Drag an end");
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (int level = 0; level < count; ++level) {
    const float x = at.x + cell * static_cast<float>(level);
    const bool on = level >= first && level <= last;
    ImU32 color =
        view.level_colors.empty() || layers.box_color != NodeMetric::level
            ? 0xffa0a0a0u
            : view.level_colors[std::min(static_cast<std::size_t>(level), view.level_colors.size() - 1)];
    if (!on || !layers.boxes) color = (color & 0x00ffffffu) | (on ? 0x80000000u : 0x30000000u);
    list->AddRectFilled({x + 1, at.y}, {x + cell - 1, at.y + height}, color, 2);
    const bool highlighted = on && level == under;
    list->AddRect({x + 1, at.y}, {x + cell - 1, at.y + height},
                  ImGui::GetColorU32(highlighted ? ImGuiCol_Text : ImGuiCol_Border), 2, 0,
                  highlighted ? 2.0f : 1.0f);
    const std::string number = std::to_string(level);
    const ImVec2 size = ImGui::CalcTextSize(number.c_str());
    if (size.x + 2 < cell)
      list->AddText({x + 0.5f * (cell - size.x), at.y + 0.5f * (height - size.y)},
                    !on              ? IM_COL32(140, 145, 155, 255)
                    : is_dark(color) ? IM_COL32(255, 255, 255, 255)
                                     : IM_COL32(0, 0, 0, 255),
                    number.c_str());
  }
  const ImU32 handle = ImGui::GetColorU32(ImGuiCol_Text);
  for (const float x : {at.x + cell * static_cast<float>(first), at.x + cell * static_cast<float>(last + 1)})
    list->AddRectFilled({x - 2, at.y - 2}, {x + 2, at.y + height + 2}, handle, 2);
}

std::int64_t boxes_shown(const Workspace& workspace, const WorkspaceView& view) {
  if (workspace.layers.box_color != NodeMetric::level) return view.boxes_drawn;
  std::int64_t boxes = 0;
  for (int level = 0; level < static_cast<int>(view.level_sizes.size()); ++level)
    if (level >= workspace.layers.first_level && level <= workspace.layers.last_level)
      boxes += view.level_sizes[static_cast<std::size_t>(level)];
  return boxes;
}

void draw_color_bar(const std::vector<std::uint32_t>& colors, const std::string& low,
                    const std::string& title, const std::string& high) {
  const float width = ImGui::GetContentRegionAvail().x, height = ImGui::GetFontSize() * 0.7f;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const std::size_t cells = 64, n = colors.size();
  for (std::size_t i = 0; i < cells; ++i) {
    const float from = at.x + width * static_cast<float>(i) / static_cast<float>(cells);
    const float to = at.x + width * static_cast<float>(i + 1) / static_cast<float>(cells);
    list->AddRectFilled({std::floor(from), at.y}, {std::floor(to), at.y + height},
                        colors[i * (n - 1) / (cells - 1)]);
  }
  ImGui::Dummy({width, height});
  faint_text(low);
  const float left = ImGui::GetStyle().WindowPadding.x;
  ImGui::SameLine(0.5f * (width - ImGui::CalcTextSize(title.c_str()).x) + left);
  faint_text(title);
  ImGui::SameLine(width - ImGui::CalcTextSize(high.c_str()).x + left);
  faint_text(high);
}

void draw_legend(const Legend& key) {
  if (!key.colors.empty()) draw_color_bar(key.colors, low_text(key), title_text(key), high_text(key));
}

void choose_broad_phase(Workspace& workspace, const WorkspaceView& view, const char* name) {
  std::string& chosen = workspace.settings.run.broad_phase;
  if (begin_choice((std::string("##") + name).c_str(), chosen.c_str())) {
    for (const std::string& method : view.broad_phases) {
      if (ImGui::Selectable(method.c_str(), method == chosen)) chosen = method;
      track(workspace, (std::string(name) + "." + method).c_str());
    }
    ImGui::EndCombo();
  }
  track(workspace, name);
  if (view.key_bits > 0)
    explain(fmt::format("Sorted by Morton codes of {} bits. Auto selects longer codes if many bodies share a "
                        "cell",
                        view.key_bits)
                .c_str());
}

void choose_box_color(Workspace& workspace, const char* name) {
  static constexpr std::array<std::pair<NodeMetric, const char*>, 5> choices{
      {{NodeMetric::level, "level"},
       {NodeMetric::sah_share, "SAH share"},
       {NodeMetric::sibling_overlap, "sibling overlap"},
       {NodeMetric::empty_space, "empty space"},
       {NodeMetric::visits, "visits"}}};
  FrameLayers& layers = workspace.layers;
  const auto* chosen =
      std::ranges::find(choices, layers.box_color, &std::pair<NodeMetric, const char*>::first);
  if (begin_choice((std::string("##") + name).c_str(), chosen->second)) {
    for (const auto& [metric, text] : choices) {
      if (ImGui::Selectable(text, metric == layers.box_color) && metric != layers.box_color) {
        layers.box_color = metric;
        if (metric != NodeMetric::level) workspace.tree.sort = metric;
        layers.box_low = 0;  // the old range belongs to another metric
        layers.box_high = std::numeric_limits<float>::infinity();
      }
      track(workspace, (std::string(name) + "." + text).c_str());
    }
    ImGui::EndCombo();
  }
  track(workspace, name);
}

}  // namespace collidoscope
