#pragma once
// Adds single input events to Dear ImGui's IO, in the form that the installed version takes: gui_events.cpp
// for ImGui 1.89 and later, gui_events_1_86.cpp for those before. Which events one frame may hold is decided
// in gui_input.cpp.

#include <array>

#include "viewer/window.h"

namespace collidoscope {

/// One per ImGui context, made before its first frame.
class GuiEvents {
 public:
  /// Needs ImGui's context.
  GuiEvents();

  /// Adds `event` to the input of the next ImGui::NewFrame(), which handles all that were added.
  void add(const InputEvent& event);

 private:
  /// Shift, control, alt, super: the left keys, then the right ones, in the order of GLFW_KEY_LEFT_SHIFT
  /// to GLFW_KEY_RIGHT_SUPER.
  std::array<bool, 8> modifier_down_{};
};

}  // namespace collidoscope
