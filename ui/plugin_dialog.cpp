#include "ui/plugin_dialog.h"

#include <imgui.h>

#include <algorithm>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {

void draw_plugin_dialog(Workspace& workspace) {
  PluginDialog& dialog = workspace.plugin;
  if (!dialog.open) return;
  const ScreenRect& at = workspace.scene_view;
  const float em = ImGui::GetFontSize();
  ImGui::SetNextWindowPos({at.x + at.width / 2, at.y + at.height / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::clamp(at.width - 4 * em, 20 * em, 44 * em), 0});
  ImGui::Begin("plug-in", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse);
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted("Load a plug-in? Its code runs with your rights.");
  ImGui::TextUnformatted(dialog.file.c_str());
  faint_text(
      "It is first tested in a separate process. Before it is loaded here, the run is saved as a snapshot.");
  ImGui::PopTextWrapPos();
  if (ImGui::Button("Load")) dialog.confirmed = true;
  track(workspace, "plugin.load");
  ImGui::SameLine();
  if (ImGui::Button("Cancel")) dialog.open = false;
  track(workspace, "plugin.cancel");
  ImGui::End();
}

}  // namespace collidoscope
