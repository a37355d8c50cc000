#pragma once
// A panel without the others, with a mouse, for pictures and clicks. Needs an OpenGL context.

#include <imgui.h>

#include "headless/pictures/panel_picture.h"
#include "ui/panels.h"
#include "ui/theme.h"
#include "viewer/render/window_frame.h"

namespace collidoscope {

struct SinglePanel {
  using Panel = void (*)(Workspace&, const WorkspaceView&);
  SinglePanel(Panel draw_panel, int w, int h) : panel(draw_panel), width(w), height(h), frame(w, h) {}
  void draw() {
    gui.begin(width, height);
    ImGui::GetIO().MousePos = pointer;
    ImGui::GetIO().MouseDown[0] = pressed;  // used by the next frame
    apply_theme(workspace.theme, ImGui::GetFontSize());
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({static_cast<float>(width), static_cast<float>(height)});
    workspace.widgets.clear();
    ImGui::Begin("details", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    panel(workspace, view);
    ImGui::End();
    gui.end(frame.target());
  }
  Image picture() {
    for (int round = 0; round < 4; ++round) draw();
    return frame.read();
  }
  void mouse(ImVec2 at, bool down) {
    pointer = at;
    pressed = down;
    draw();
    draw();
  }

  Panel panel;
  int width, height;
  GuiPass gui{13};
  WindowFrame frame;
  Workspace workspace;
  WorkspaceView view;
  ImVec2 pointer{-1, -1};
  bool pressed = false;
};

}  // namespace collidoscope
