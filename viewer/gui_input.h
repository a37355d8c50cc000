#pragma once
// Passes window events to Dear ImGui. ImGui 1.86 loses a press and release within one frame, which happens at
// low frame rates. An event that does not fit into one frame therefore waits for the next. ImGui's GLFW
// backend is not used, since the camera must handle the same events in the same frame.

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "viewer/gui_events.h"
#include "viewer/window.h"

namespace collidoscope {

/// Removes the events of the next frame from `events` and returns them.
std::vector<InputEvent> take_events_of_a_frame(std::deque<InputEvent>& events);

class GuiInput {
 public:
  /// Precondition: an ImGui context exists. Keeps a reference to the window.
  explicit GuiInput(Window& window);

  /// Call before ImGui::NewFrame(). Adds the events of this frame to ImGui and returns them.
  std::vector<InputEvent> feed();

  /// Number of releases of keys and buttons so far.
  std::int64_t releases() const { return releases_; }

 private:
  static const char* get_clipboard(void* self);
  static void set_clipboard(void* self, const char* text);

  Window& window_;
  GuiEvents gui_;
  std::string clipboard_;
  std::int64_t releases_ = 0;
};

}  // namespace collidoscope
