#pragma once
// Passes a window's events to Dear ImGui. A press and its release between two drawn frames, as they come
// where frames are slow, cancel out in ImGui 1.86. So an event that one frame cannot hold waits for the next.
// ImGui's own GLFW backend is not used: the camera must handle the same events in the same frame.

#include <deque>
#include <string>
#include <vector>

#include "viewer/gui_events.h"
#include "viewer/window.h"

namespace collidoscope {

/// Removes from `events` those that one frame can hold, and returns them.
std::vector<InputEvent> take_events_of_a_frame(std::deque<InputEvent>& events);

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
  GuiEvents gui_;
  std::string clipboard_;
};

}  // namespace collidoscope
