#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

void layer_switch(Workspace& workspace, const char* name, const char* label, bool& on) {
  ImGui::Checkbox(label, &on);
  track(workspace, (std::string("layers.") + name).c_str());
}

// A bar with a cell for each level and a handle at each end of the range that is shown. Whichever end is
// nearer to the pointer follows it.
void draw_level_bar(Workspace& workspace, const WorkspaceView& view) {
  const int count = static_cast<int>(view.level_sizes.size());
  if (count == 0) {
    faint_text("no tree here");
    return;
  }
  ShownLayers& layers = workspace.layers;
  int first = std::clamp(layers.first_level, 0, count - 1),
      last = std::clamp(layers.last_level, first, count - 1);
  const float height = ImGui::GetFontSize() * 1.3f, width = ImGui::GetContentRegionAvail().x;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float cell = width / static_cast<float>(count);
  ImGui::InvisibleButton("levels", {width, height});
  track(workspace, "layers.levels");
  if (ImGui::IsItemActive()) {
    const int under = std::clamp(static_cast<int>((ImGui::GetIO().MousePos.x - at.x) / cell), 0, count - 1);
    ImGuiStorage* memory = ImGui::GetStateStorage();
    const ImGuiID which = ImGui::GetID("end");
    if (ImGui::IsItemActivated())
      memory->SetInt(which, std::abs(under - first) < std::abs(under - last) || under < first ? 0 : 1);
    if (memory->GetInt(which) == 0)
      first = std::min(under, last);
    else
      last = std::max(under, first);
    layers.first_level = first;
    layers.last_level = last == count - 1 ? 63 : last;  // "to the leaves" stays so when the tree grows
  }
  explain("Drag either end: levels of the hierarchy that are shown, 0 is the root");
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (int level = 0; level < count; ++level) {
    const float x = at.x + cell * static_cast<float>(level);
    const bool on = level >= first && level <= last;
    ImU32 color = view.level_colors.empty()
                      ? 0xff808080u
                      : view.level_colors[static_cast<std::size_t>(level) % view.level_colors.size()];
    if (!on || !layers.boxes) color = (color & 0x00ffffffu) | (on ? 0x80000000u : 0x30000000u);
    list->AddRectFilled({x + 1, at.y}, {x + cell - 1, at.y + height}, color, 2);
    list->AddRect({x + 1, at.y}, {x + cell - 1, at.y + height}, ImGui::GetColorU32(ImGuiCol_Border), 2);
    const std::string number = std::to_string(level);
    const ImVec2 size = ImGui::CalcTextSize(number.c_str());
    if (size.x + 2 < cell)
      list->AddText({x + 0.5f * (cell - size.x), at.y + 0.5f * (height - size.y)},
                    on ? IM_COL32(0, 0, 0, 255) : IM_COL32(140, 145, 155, 255), number.c_str());
  }
  const ImU32 handle = ImGui::GetColorU32(ImGuiCol_Text);
  for (const float x : {at.x + cell * static_cast<float>(first), at.x + cell * static_cast<float>(last + 1)})
    list->AddRectFilled({x - 2, at.y - 2}, {x + 2, at.y + height + 2}, handle, 2);
  std::int64_t boxes = 0;
  for (int level = first; level <= last; ++level) boxes += view.level_sizes[static_cast<std::size_t>(level)];
  faint_text(first == last ? fmt::format("level {}: {} boxes", first, grouped_number(boxes))
                           : fmt::format("levels {} to {}: {} boxes", first, last, grouped_number(boxes)));
}

// A bar of colours from least to greatest, with what stands at its ends and in its middle.
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

void draw_legend(const WorkspaceView& view) {
  if (view.map_colors.empty()) return;
  const auto number = [](double value) {
    return std::abs(value) >= 1e4 ? grouped_number(static_cast<std::int64_t>(value))
                                  : fmt::format("{:.4g}", value);
  };
  draw_color_bar(view.map_colors, number(view.legend_min),
                 view.legend_unit.empty() ? view.legend_title : view.legend_title + " · " + view.legend_unit,
                 (view.legend_goes_on ? "≥ " : "") + number(view.legend_max));
}

void draw_contact_legend(const WorkspaceView& view) {
  if (view.max_impulse > 0 && !view.contact_colors.empty())
    draw_color_bar(view.contact_colors, "≤ " + with_prefix(view.max_impulse / 1000, "N s"), "impulse",
                   with_prefix(view.max_impulse, "N s"));
  else
    faint_text("impulses: none known of the last step");
}

}  // namespace

void draw_layers_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "layers", "Layers", workspace.folds.layers)) return end_panel();
  ShownLayers& layers = workspace.layers;
  const float column = ImGui::GetContentRegionAvail().x / 3 + ImGui::GetStyle().WindowPadding.x;
  layer_switch(workspace, "spheres", "spheres", layers.spheres);
  ImGui::SameLine(column);
  layer_switch(workspace, "contacts", "contacts", layers.contacts);
  ImGui::SameLine(2 * column - ImGui::GetStyle().WindowPadding.x);
  layer_switch(workspace, "boxes", "boxes", layers.boxes);
  layer_switch(workspace, "grid", "grid", layers.grid);
  ImGui::SameLine(column);
  layer_switch(workspace, "walls", "walls", layers.walls);
  if (layers.boxes) draw_level_bar(workspace, view);
  static constexpr std::array<std::pair<BodyColor, const char*>, 5> colors{
      {{BodyColor::speed, "speed"},
       {BodyColor::radius, "radius"},
       {BodyColor::id, "id"},
       {BodyColor::contacts, "contacts"},
       {BodyColor::order, "order in the tree"}}};
  row_label("colour by");
  const char* chosen = "";
  for (const auto& [color, name] : colors)
    if (color == layers.color) chosen = name;
  if (begin_choice("##color", chosen)) {
    for (const auto& [color, name] : colors) {
      if (ImGui::Selectable(name, color == layers.color)) layers.color = color;
      track(workspace, (std::string("layers.color.") + name).c_str());
    }
    ImGui::EndCombo();
  }
  track(workspace, "layers.color");
  draw_legend(view);
  if (layers.contacts) draw_contact_legend(view);
  end_panel();
}

}  // namespace collidoscope
