#include <fmt/format.h>
#include <imgui.h>

#include <cmath>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

/// Behind the scene's name; in a row of its own where the name leaves no room.
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
    explain("What decides the state was changed since state 0: this run is not the one that its flags name.");
  }
  if (changes.empty()) return;
  if (fits || view.edited)
    ImGui::SameLine(button_at);
  else
    ImGui::SetCursorPosX(button_at);
  if (ImGui::SmallButton(changes.c_str())) workspace.changes_file_requested = true;
  track(workspace, "run.changes");
  explain(
      "Writes what was changed, and at which states, to captures/: from this file, collidoscope-headless "
      "makes the same run again, to the same hash");
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
    explain("Space");
    ImGui::SameLine();
    if (ImGui::Button("Step", {third, 0})) workspace.request_step();
    track(workspace, "run.step");
    explain("S: one step, then pause");
    ImGui::SameLine();
    if (ImGui::Button("Restart", {third, 0})) workspace.restart_requested = true;
    track(workspace, "run.restart");
    explain("R: back to state 0, with these settings");

    const char* chosen = "";
    for (const auto& [speed, name] : speed_choices)
      if (speed == workspace.speed) chosen = name;
    row_label("speed", "What is wished for; never more than one step in a drawn frame");
    if (begin_choice("##speed", chosen)) {
      for (const auto& [speed, name] : speed_choices) {
        if (ImGui::Selectable(name, speed == workspace.speed)) workspace.speed = speed;
        track(workspace, (std::string("run.speed.") + name).c_str());
      }
      ImGui::EndCombo();
    }
    track(workspace, "run.speed");
    row_text("state", fmt::format("{}{}", grouped_number(view.stats.step),
                                  std::isfinite(view.time) ? fmt::format(" · t = {:.3f} s", view.time) : ""));
    row_text("real time",
             view.with_times && view.frames_per_second > 0
                 ? fmt::format("{:.2f} × · {:.0f} frames/s", view.real_time_factor, view.frames_per_second)
                 : "–",
             "Simulated seconds in a second of the clock, over the last second");
  }
  end_panel();
}

}  // namespace collidoscope
