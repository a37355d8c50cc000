#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "ui/launch_text.h"
#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

/// Last value, median and 95th percentile in ms, one cell each. Not `shown` or not measured: dashes.
void time_cells(const TimeSummary& times, bool shown) {
  for (double ms : {times.now, times.median, times.p95})
    number_cell(shown && times.samples > 0 ? short_time(ms) : "–");
}

/// Tooltip of a stage: its standard term and its launch shape.
std::string stage_text(const History::Stage& stage) {
  const std::string launch = launch_text(stage);
  return std::string(stage_term(stage.name)) + (launch.empty() ? "" : "\n" + launch);
}

}  // namespace

void draw_timing_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "timing", "Timing", workspace.visible_panels.timing)) return end_panel();
  const History& history = *view.history;
  const auto window = static_cast<std::size_t>(std::max(workspace.window, 1));
  const TimeSummary sum = history.summarize_sum(window), whole = history.summarize_plain(window);
  const bool light = workspace.theme == Theme::light;
  const int highlighted = workspace.hovered_stage >= 0 ? workspace.hovered_stage : workspace.chosen_stage;
  int hovered = -1;
  if (ImGui::BeginTable("stages", 6, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_PadOuterX)) {
    // Relative widths, which scale with the panel and the font.
    for (const auto& [column, share] :
         {std::pair{"stage", 6.8f}, std::pair{"last", 3.4f}, std::pair{"median", 3.4f},
          std::pair{"p95", 3.4f}, std::pair{"share", 3.0f}, std::pair{"launches", 4.4f}})
      ImGui::TableSetupColumn(column, ImGuiTableColumnFlags_WidthStretch, share);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    faint_text("stage, ms");
    for (const char* column : {"last", "median", "p95", "share", "launches"}) {
      ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
      number_cell(column);
      ImGui::PopStyleColor();
    }
    for (std::size_t k = 0; k < history.stages().size(); ++k) {
      const History::Stage& stage = history.stages()[k];
      const TimeSummary times = history.summarize_stage(k, window);
      if (times.samples == 0)
        continue;  // not measured in this window, for example a stage of another broad phase
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      const ImVec2 at = ImGui::GetCursorScreenPos();
      const float size = ImGui::GetFontSize();
      ImGui::GetWindowDrawList()->AddRectFilled(
          {at.x, at.y + 0.25f * size}, {at.x + 0.55f * size, at.y + 0.8f * size}, stage_color(k, light), 2);
      ImGui::SetCursorPosX(ImGui::GetCursorPosX() + size);
      if (ImGui::Selectable((stage.name + (stage.library_launch ? " *" : "")).c_str(),
                            highlighted == static_cast<int>(k), ImGuiSelectableFlags_SpanAllColumns))
        workspace.chosen_stage = workspace.chosen_stage == static_cast<int>(k) ? -1 : static_cast<int>(k);
      if (ImGui::IsItemHovered()) hovered = static_cast<int>(k);
      track(workspace, ("timing." + stage.name).c_str());
      explain(stage_text(stage).c_str());
      time_cells(times, view.with_times);
      number_cell(view.with_times && sum.median > 0 ? fmt::format("{:.0f} %", 100 * times.median / sum.median)
                                                    : "–");
      number_cell(std::to_string(stage.launches));
    }
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted("sum of stages");
    explain("Sum of the stage times, in ms. Stages are timed in every second step");
    time_cells(sum, view.with_times);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted("whole step");
    explain("Time of a whole step, in ms, measured in the steps without stage timers");
    time_cells(whole, view.with_times);
    ImGui::EndTable();
  }
  if (hovered >= 0) workspace.hovered_stage = hovered;
  const bool any_library_launch = std::ranges::any_of(history.stages(), &History::Stage::library_launch);
  faint_text(fmt::format("last {} steps{}", std::min(window, history.size()),
                         any_library_launch ? " · * library launch" : ""));
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  ImGui::SameLine(ImGui::GetContentRegionAvail().x - 2 * ImGui::CalcTextSize("JSON").x - 3 * gap - gap);
  if (ImGui::SmallButton("CSV")) workspace.csv_requested = true;
  track(workspace, "timing.csv");
  explain("Writes the times of these steps to captures/ as CSV, one row per step");
  ImGui::SameLine();
  if (ImGui::SmallButton("JSON")) workspace.json_requested = true;
  track(workspace, "timing.json");
  explain("Writes the times of these steps to captures/ as JSON");
  end_panel();
}

}  // namespace collidoscope
