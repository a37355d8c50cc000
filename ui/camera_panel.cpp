#include <imgui.h>

#include <algorithm>
#include <array>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {

void draw_camera_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "camera", "View", workspace.visible_panels.camera)) return end_panel();
  struct Button {
    const char *name, *label, *help;
    CameraRequest request;
  };
  static constexpr std::array<Button, 5> buttons{
      {{"camera.all", "All", "Shift+F: frame all bodies", CameraRequest::frame_all},
       {"camera.front", "Front", "1: front view", CameraRequest::front},
       {"camera.side", "Side", "3: side view", CameraRequest::side},
       {"camera.top", "Top", "7: top view", CameraRequest::top},
       {"camera.ortho", "Ortho", "5: toggle perspective", CameraRequest::orthographic}}};
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float width = (ImGui::GetContentRegionAvail().x - 4 * gap) / 5;
  for (const Button& button : buttons) {
    const bool on = button.request == CameraRequest::orthographic && view.orthographic;
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button(button.label, {width, 0})) workspace.camera_request = button.request;
    if (on) ImGui::PopStyleColor();
    track(workspace, button.name);
    explain(button.help);
    if (&button != &buttons.back()) ImGui::SameLine();
  }
  bool light = workspace.theme == Theme::light;
  if (ImGui::Checkbox("light theme", &light)) workspace.theme = light ? Theme::light : Theme::dark;
  track(workspace, "view.light");
  ImGui::SameLine();
  if (ImGui::Button("Picture")) workspace.screenshot_requested = true;
  track(workspace, "view.picture");
  explain("P: writes the window as a PNG to captures/");
  ImGui::SameLine();
  if (ImGui::Button("Keys")) workspace.help = !workspace.help;
  track(workspace, "view.help");
  explain("F1: list of keys");
  end_panel();
}

}  // namespace collidoscope
