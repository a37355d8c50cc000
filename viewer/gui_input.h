#pragma once
// Hands a window's events to Dear ImGui. A press and its release that come between two drawn frames, as they
// do where frames are slow, would cancel out in ImGui 1.86, which is why its own GLFW backend is not used:
// events wait for the next frame where one frame cannot hold them.

#include <set>
#include <string>
#include <vector>

#include "viewer/window.h"

namespace collidoscope {

class GuiInput {
 public:
  /// Needs ImGui's context; keeps a reference to the window.
  explicit GuiInput(Window& window);

  /// Before ImGui::NewFrame(): takes the events that this frame can hold, and returns them.
  std::vector<InputEvent> feed();

 private:
  static const char* get_clipboard(void* self);
  static void set_clipboard(void* self, const char* text);

  Window& window_;
  std::string clipboard_;
};

}  // namespace collidoscope
