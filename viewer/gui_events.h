#pragma once
// Adds input events to Dear ImGui's IO for the installed version: gui_events.cpp for ImGui 1.89 and later,
// gui_events_1_86.cpp for earlier ones. gui_input.cpp selects the events of each frame.

#include <array>

#include "viewer/window.h"

namespace collidoscope {

/// One instance per ImGui context, made before its first frame.
class GuiEvents {
 public:
  /// Precondition: an ImGui context exists.
  GuiEvents();

  /// Adds `event` to the input of the next ImGui::NewFrame().
  void add(const InputEvent& event);

 private:
  /// Left and right shift, control, alt and super, ordered from GLFW_KEY_LEFT_SHIFT to GLFW_KEY_RIGHT_SUPER.
  std::array<bool, 8> modifier_down_{};
};

}  // namespace collidoscope
