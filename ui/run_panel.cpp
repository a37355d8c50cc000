#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

/// "edited" and the number of changes, after the scene name or in a row of their own if it is too long.
void draw_edited(Workspace& workspace, const WorkspaceView& view) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const auto width_of = [](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x; };
  const std::string changes = view.changes > 0 ? fmt::format("{} change{}", grouped_number(view.changes),
                                                             view.changes == 1 ? "" : "s")
                                               : "";
  const float button = changes.empty() ? 0 : width_of(changes) + 2 * style.FramePadding.x;
  const float button_at = ImGui::GetContentRegionMax().x - button;
  const float edited = view.edited ? width_of("edited") + style.ItemSpacing.x : 0;
  const float name_end = ImGui::GetCursorPosX() + width_of(view.scene) + style.ItemSpacing.x;
  const bool fits = name_end + edited <= button_at;
  if (view.edited) {
    if (fits) ImGui::SameLine();
    const bool light = workspace.theme == Theme::light;
    ImGui::TextColored(light ? ImVec4(0.60f, 0.33f, 0, 1) : ImVec4(0.95f, 0.66f, 0.22f, 1), "edited");
    track(workspace, "run.edited");
    explain(
        "A setting that affects the result was changed since state 0. The initial settings alone do not "
        "reproduce this run.");
  }
  if (changes.empty()) return;
  if (fits || view.edited)
    ImGui::SameLine(button_at);
  else
    ImGui::SetCursorPosX(button_at);
  if (ImGui::SmallButton(changes.c_str())) workspace.changes_file_requested = true;
  track(workspace, "run.changes");
  explain(
      "Writes all changes and their states to captures/. collidoscope-headless repeats the run from this "
      "file, to the same hash");
}

/// A slider over all states of the run, between buttons for the states before and after.
void draw_timeline(Workspace& workspace, const WorkspaceView& view) {
  const WorkspaceView::TimelineView& timeline = *view.timeline;
  const std::int64_t now = view.stats.step;
  const auto request = [&](std::int64_t state) {
    workspace.request_state(std::clamp(state, timeline.first, timeline.last));
  };
  row_label("timeline", "All states of this run. A change in an earlier state begins a branch");
  const float gap = ImGui::GetStyle().ItemInnerSpacing.x, button = ImGui::GetFrameHeight();
  const float save = ImGui::CalcTextSize("save").x + 2 * ImGui::GetStyle().FramePadding.x;
  const float width = ImGui::GetContentRegionAvail().x - 3 * (button + gap) - save - gap;
  if (workspace.backwards)
    ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  const bool was_backwards = workspace.backwards;
  if (ImGui::ArrowButton("##backwards", ImGuiDir_Left)) workspace.play_or_pause_backwards();
  if (was_backwards) ImGui::PopStyleColor();
  track(workspace, "run.backwards");
  explain("Shift+Space: play backwards");
  ImGui::SameLine(0, gap);
  if (ImGui::Button("<##state", {button, 0})) request(now - 1);
  track(workspace, "run.back");
  explain("Shift+S: the state before");
  ImGui::SameLine(0, gap);
  ImGui::SetNextItemWidth(width);
  std::int64_t state = now;
  // Without a text, which the handle would hide: the row above has it.
  if (ImGui::SliderScalar("##timeline", ImGuiDataType_S64, &state, &timeline.first, &timeline.last, " ",
                          ImGuiSliderFlags_AlwaysClamp) &&
      state != now)
    request(state);
  track(workspace, "run.timeline");
  explain("Drag: go to a state of this run");
  ImGui::SameLine(0, gap);
  if (ImGui::Button(">##state", {button, 0})) workspace.request_step();
  track(workspace, "run.forward");
  explain("S: the next state");
  ImGui::SameLine(0, gap);
  if (ImGui::Button("save", {save, 0})) workspace.recording_requested = true;
  track(workspace, "run.save");
  explain(
      "Ctrl+S: writes all states of this run to captures/. collidoscope opens the file, and "
      "collidoscope-headless "
      "replay verifies it");
}

}  // namespace

void draw_run_panel(Workspace& workspace, const WorkspaceView& view) {
  if (begin_panel(workspace, "run", "Run", workspace.visible_panels.run)) {
    ImGui::TextUnformatted(view.scene.c_str());
    draw_edited(workspace, view);
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const float third = (ImGui::GetContentRegionAvail().x - 2 * gap) / 3;
    if (ImGui::Button(workspace.playing ? "Pause" : "Play", {third, 0})) workspace.play_or_pause();
    track(workspace, "run.play");
    explain("Space: play or pause");
    ImGui::SameLine();
    if (ImGui::Button("Step", {third, 0})) workspace.request_step();
    track(workspace, "run.step");
    explain("S: one step, then pause");
    ImGui::SameLine();
    if (ImGui::Button("Restart", {third, 0})) workspace.restart_requested = true;
    track(workspace, "run.restart");
    explain("R: restart at state 0 with these settings");
    if (view.has_body_file) {
      row_label("file");
      if (ImGui::SmallButton("columns ...")) workspace.columns_requested = true;
      track(workspace, "run.columns");
      explain("Choose the columns, the radius and the unit of length, and open the file again");
    }

    const char* chosen = "";
    for (const SpeedChoice& choice : speed_choices)
      if (choice.speed == workspace.speed) chosen = choice.label;
    row_label("speed", "Requested speed: simulated seconds per second");
    if (begin_choice("##speed", chosen)) {
      for (const auto& [speed, name, label] : speed_choices) {
        if (ImGui::Selectable(label, speed == workspace.speed)) workspace.speed = speed;
        track(workspace, (std::string("run.speed.") + name).c_str());
      }
      ImGui::EndCombo();
    }
    track(workspace, "run.speed");
    row_text("state",
             fmt::format("{}{}{}", grouped_number(view.stats.step),
                         view.timeline ? fmt::format(" of {}", grouped_number(view.timeline->last)) : "",
                         std::isfinite(view.time) ? fmt::format(" · t = {:.3f} s", view.time) : ""));
    if (view.timeline) draw_timeline(workspace, view);
    row_text(
        "achieved",
        view.with_times && view.frames_per_second > 0
            ? fmt::format("{:.2f} × real time · {:.0f} fps", view.real_time_factor, view.frames_per_second)
            : "–",
        "Simulated seconds per second, and drawn frames per second, over the last second. It is "
        "below the requested speed if steps take too long");
  }
  end_panel();
}

}  // namespace collidoscope
