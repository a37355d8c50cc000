// Panel Launch map: time of a step, or of a stage, over B and T, measured on request while the run continues.
// A click on a cell applies its shape.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/launch_map_chart.h"
#include "ui/number_field.h"
#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

void wrapped(const std::string& text) { ImGui::TextWrapped("%s", text.c_str()); }

void draw_controls(Workspace& workspace, const LaunchMapView& map) {
  LaunchMapRequests& requests = workspace.launch_map;
  const float em = ImGui::GetFontSize();
  const bool measures = map.begun && !map.done;
  const char* const label = !measures ? "measure" : requests.running ? "stop" : "resume";
  if (ImGui::Button(label, {4.6f * em, 0})) {
    if (measures)
      requests.running = !requests.running;
    else
      requests.restart = true;
  }
  track(workspace, "launch_map.measure");
  explain("Compares launch shapes on two copies of the present state, while the run continues");
  ImGui::SameLine();
  const float share = map.budget > 0 ? static_cast<float>(std::min(map.spent / map.budget, 1.0)) : 0;
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  ImGui::ProgressBar(map.done ? 1 : share, {-1, 0},
                     !map.begun ? ""
                     : map.done ? "all measured"
                                : fmt::format("{:.0f} %", 100 * share).c_str());
  ImGui::PopStyleColor();
  row_label("budget", "Time of all measurements together, s; used by the next map");
  ImGui::PushID("budget");
  number_field(workspace, "launch_map.budget", "budget", requests.budget, {0.5, 3600.0, "s"}, "{:.3g} s");
  ImGui::PopID();
  draw_input_fault(workspace, "launch_map.budget");
  if (map.stages.empty()) return;
  row_label("time of", "The whole step, or a stage that obeys B and T");
  if (begin_choice("##stage", requests.stage.empty() ? "step" : requests.stage.c_str())) {
    if (ImGui::Selectable("step", requests.stage.empty())) requests.stage.clear();
    for (const LaunchMapView::Stage& stage : map.stages)
      if (ImGui::Selectable(stage.name.c_str(), stage.name == requests.stage)) requests.stage = stage.name;
    ImGui::EndCombo();
  }
  track(workspace, "launch_map.stage");
}

void draw_results(Workspace& workspace, const LaunchMapView& map, bool with_times) {
  const auto wrong = std::ranges::find(map.cells, LaunchCell::State::wrong, &LaunchCell::state);
  if (wrong != map.cells.end())
    wrapped(fmt::format("ERROR: B = {}, T = {} gives another result: {}", wrong->shape.blocks,
                        wrong->shape.threads, wrong->reason));
  if (!map.verdict.empty()) {
    ImGui::BeginDisabled(!map.is_faster);
    if (ImGui::Button("apply")) workspace.settings.run.shape = map.cells[*map.chosen].shape;
    ImGui::EndDisabled();
    if (map.is_faster) track(workspace, "launch_map.apply");
    explain("Applies the chosen shape: the centre of those that cannot be told apart from the fastest");
    ImGui::SameLine();
    if (with_times) wrapped(map.verdict);
  }
  if (!map.stage_verdict.empty() && with_times) {
    ImGui::TextWrapped("a shape per stage: %s", map.stage_verdict.c_str());
    explain(("--stage-shapes " + map.stage_shapes).c_str());
  }
  faint_text(
      fmt::format("from state {}, {} bodies", grouped_number(map.start_state), grouped_number(map.bodies)));
  faint_text(map.plateau.size() > 1 ? "outlined: not told apart from the fastest" : "outlined: the fastest");
  faint_text("diagonals: equal B × T");
}

}  // namespace

void draw_launch_map_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "launch_map", "Launch map", workspace.visible_panels.launch_map))
    return end_panel();
  if (view.launch_map == nullptr) {
    faint_text("available after the next frame");
    return end_panel();
  }
  const LaunchMapView& map = *view.launch_map;
  draw_controls(workspace, map);
  if (!map.unavailable_reason.empty()) wrapped(map.unavailable_reason);
  if (!map.cells.empty()) {
    const LaunchMapTimes shown = launch_map_times(map, workspace.launch_map.stage);
    draw_launch_map(workspace, view, map, shown);
    if (std::isfinite(shown.fastest)) draw_launch_map_scale(map, shown, view.with_times);
    draw_results(workspace, map, view.with_times);
  }
  end_panel();
}

}  // namespace collidoscope
