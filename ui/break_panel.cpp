// Panel Break when: one row per break condition, evaluated at each state while switched on. A stop is shown
// as one line here and over the 3D view, with buttons.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "ui/number_field.h"
#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

void draw_condition(Workspace& workspace, const BreakConditionName& condition) {
  const auto k = static_cast<std::size_t>(condition.condition);
  BreakRequests& requests = workspace.breaks;
  const auto& [label, help] = break_text(condition.condition);
  const std::string name(condition.name);
  ImGui::PushID(name.c_str());
  ImGui::Checkbox(label, &requests.on[k]);
  track(workspace, ("breaks." + name).c_str());
  explain(fmt::format("Stops if {}", condition.meaning).c_str());
  if (condition.has_limit) {
    ImGui::SameLine(ImGui::GetFontSize() * 10);
    ImGui::SetNextItemWidth(-1);
    const std::string unit(condition.unit), field = "breaks." + name + ".limit";
    number_field(workspace, field.c_str(), label, requests.limits[k], {0, condition.max_limit, unit.c_str()},
                 ("{:.6g} " + unit).c_str());
    draw_input_fault(workspace, field.c_str());
  }
  ImGui::PopID();
}

/// The stop line and its buttons. `where`: prefix of the widget names.
void draw_stop(Workspace& workspace, const StopView& stop, const std::string& where) {
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(stop.what.c_str());
  ImGui::PopTextWrapPos();
  StopRequest& request = workspace.breaks.stop;
  if (ImGui::Button("resume")) request = StopRequest::resume;
  track(workspace, (where + ".go_on").c_str());
  explain(stop.is_violation ? "Runs the failing step with guards switched off"
                            : "Stops again the next time the condition becomes true");
  if (stop.body) {
    ImGui::SameLine();
    ImGui::BeginDisabled(!stop.can_freeze);
    if (ImGui::Button(fmt::format("freeze body {}", *stop.body).c_str())) request = StopRequest::freeze;
    ImGui::EndDisabled();
    track(workspace, (where + ".freeze").c_str());
    explain("Fixes the body in place, at rest. Bodies that never touch it are not affected");
  }
  ImGui::SameLine();
  if (ImGui::Button(fmt::format("save state {}", grouped_number(stop.state_before)).c_str()))
    request = StopRequest::save;
  track(workspace, (where + ".save").c_str());
  explain("Writes a snapshot of the state before that step. A run from it reproduces the stop");
}

}  // namespace

void draw_break_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "breaks", "Break when", workspace.visible_panels.breaks)) return end_panel();
  for (const BreakConditionName& condition : break_condition_names) draw_condition(workspace, condition);
  if (view.stop) {
    ImGui::Separator();
    draw_stop(workspace, *view.stop, "breaks");
  }
  end_panel();
}

void draw_stop_bar(Workspace& workspace, const WorkspaceView& view) {
  if (!view.stop) return;
  const ScreenRect& at = workspace.scene_view;
  const float margin = ImGui::GetFontSize();
  const bool light = workspace.theme == Theme::light;
  // Position above the hint and the notice.
  ImGui::SetNextWindowPos({at.x + margin, at.y + at.height - 5 * margin}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSize({std::max(at.width - 2 * margin, 100.0f), 0});
  ImGui::PushStyleColor(ImGuiCol_WindowBg,
                        light ? ImVec4(1, 0.93f, 0.76f, 0.97f) : ImVec4(0.30f, 0.21f, 0.05f, 0.97f));
  ImGui::PushStyleColor(ImGuiCol_Button,
                        light ? ImVec4(0.93f, 0.79f, 0.48f, 1) : ImVec4(0.48f, 0.35f, 0.11f, 1));
  ImGui::Begin("stop", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  draw_stop(workspace, *view.stop, "stop");
  ImGui::End();
  ImGui::PopStyleColor(2);
}

}  // namespace collidoscope
