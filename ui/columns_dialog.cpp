#include "ui/columns_dialog.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "ui/number_field.h"
#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

/// The list of quantities in the head of a column.
void choose_meaning(Workspace& workspace, ColumnsDialog& dialog, std::size_t column) {
  int& meaning = dialog.meaning[column];
  const std::string name = fmt::format("columns.{}", column + 1);
  const auto text_of = [&](int quantity) {
    return quantity < 0 ? std::string("not used") : dialog.quantities[static_cast<std::size_t>(quantity)];
  };
  ImGui::SetNextItemWidth(-1);
  const bool open = begin_choice("##meaning", text_of(meaning).c_str());
  if (open) {
    for (int quantity = -1; quantity < static_cast<int>(dialog.quantities.size()); ++quantity) {
      if (ImGui::Selectable(text_of(quantity).c_str(), quantity == meaning)) {
        // A quantity has one column.
        std::ranges::replace(dialog.meaning, quantity, -1);
        meaning = quantity;
      }
      track(workspace, (name + "." + text_of(quantity)).c_str());
    }
    ImGui::EndCombo();
  }
  if (!open) track(workspace, name.c_str());
}

void draw_table(Workspace& workspace, ColumnsDialog& dialog) {
  constexpr std::size_t most_columns = 60;  // of a table of Dear ImGui
  const int columns = static_cast<int>(std::min(dialog.names.size(), most_columns));
  const float width = 6.5f * ImGui::GetFontSize();
  const ImGuiStyle& style = ImGui::GetStyle();
  const float row_height = ImGui::GetTextLineHeight() + 2 * style.CellPadding.y;
  const float height = ImGui::GetFrameHeight() + 2 * style.CellPadding.y + style.ScrollbarSize +
                       row_height * static_cast<float>(dialog.rows.size() + 1);
  constexpr ImGuiTableFlags flags = ImGuiTableFlags_Borders | ImGuiTableFlags_ScrollX |
                                    ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_RowBg;
  if (!ImGui::BeginTable("##columns", columns, flags, {0, height})) return;
  for (int k = 0; k < columns; ++k) ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, width);
  ImGui::TableNextRow();
  for (int k = 0; k < columns; ++k) {
    ImGui::TableNextColumn();
    ImGui::PushID(k);
    choose_meaning(workspace, dialog, static_cast<std::size_t>(k));
    ImGui::PopID();
  }
  ImGui::TableNextRow();
  for (int k = 0; k < columns; ++k) {
    ImGui::TableNextColumn();
    faint_text(dialog.names[static_cast<std::size_t>(k)]);
  }
  for (const std::vector<std::string>& row : dialog.rows) {
    ImGui::TableNextRow();
    for (int k = 0; k < columns; ++k) {
      ImGui::TableNextColumn();
      if (static_cast<std::size_t>(k) < row.size())
        ImGui::TextUnformatted(row[static_cast<std::size_t>(k)].c_str());
    }
  }
  ImGui::EndTable();
}

bool has_quantity(const ColumnsDialog& dialog, const char* name) {
  return std::ranges::any_of(dialog.meaning, [&](int quantity) {
    return quantity >= 0 && dialog.quantities[static_cast<std::size_t>(quantity)] == name;
  });
}

}  // namespace

void draw_columns_dialog(Workspace& workspace) {
  ColumnsDialog& dialog = workspace.columns;
  if (!dialog.open) return;
  const ScreenRect& at = workspace.scene_view;
  const float em = ImGui::GetFontSize();
  const float width = std::clamp(7.3f * em * static_cast<float>(dialog.names.size()) + 2 * em, 26 * em,
                                 std::max(at.width - 2 * em, 26 * em));
  ImGui::SetNextWindowPos({at.x + at.width / 2, at.y + at.height / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({width, 0});
  ImGui::Begin("columns", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse);
  ImGui::TextUnformatted(fmt::format("Columns of {}", dialog.file).c_str());
  faint_text(dialog.format);
  draw_table(workspace, dialog);
  ImGui::PushItemWidth(8 * em);
  if (!has_quantity(dialog, "radius") && !has_quantity(dialog, "diameter")) {
    row_label("radius, m", "Radius of all bodies. 0: a quarter of their mean distance");
    number_field(workspace, "columns.radius", "radius", dialog.radius, NumberRange<double>{0, 1e9, "m"},
                 "{:g}");
    draw_input_fault(workspace, "columns.radius");
  }
  row_label("unit, m", "Length of the file's unit: 0.001 for millimetres");
  number_field(workspace, "columns.scale", "unit", dialog.scale, NumberRange<double>{1e-15, 1e15, "m"},
               "{:g}");
  draw_input_fault(workspace, "columns.scale");
  ImGui::PopItemWidth();
  if (!dialog.fault.empty()) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextColored(
        workspace.theme == Theme::light ? ImVec4(0.7f, 0.1f, 0.1f, 1) : ImVec4(1, 0.5f, 0.45f, 1), "%s",
        dialog.fault.c_str());
    ImGui::PopTextWrapPos();
  }
  ImGui::BeginDisabled(!dialog.fault.empty());
  if (ImGui::Button("Open")) dialog.confirmed = true;
  ImGui::EndDisabled();
  track(workspace, "columns.open");
  ImGui::SameLine();
  if (ImGui::Button("Cancel")) dialog.open = false;
  track(workspace, "columns.cancel");
  ImGui::End();
}

}  // namespace collidoscope
