#include "viewer/gui_input.h"

#include <imgui.h>

#include <set>

namespace collidoscope {

GuiInput::GuiInput(Window& window) : window_(window) {
  ImGuiIO& io = ImGui::GetIO();
  io.GetClipboardTextFn = get_clipboard;
  io.SetClipboardTextFn = set_clipboard;
  io.ClipboardUserData = this;
  io.BackendPlatformName = "collidoscope";
}

const char* GuiInput::get_clipboard(void* self) {
  auto& input = *static_cast<GuiInput*>(self);
  input.clipboard_ = input.window_.clipboard();
  return input.clipboard_.c_str();
}

void GuiInput::set_clipboard(void* self, const char* text) {
  static_cast<GuiInput*>(self)->window_.set_clipboard(text);
}

std::vector<InputEvent> GuiInput::feed() {
  std::vector<InputEvent> taken = take_events_of_a_frame(window_.events());
  for (const InputEvent& event : taken) {
    gui_.add(event);
    const bool pressed = event.down || event.repeat;
    releases_ += !pressed && (event.kind == InputEvent::Kind::key || event.kind == InputEvent::Kind::button);
  }
  return taken;
}

std::vector<InputEvent> take_events_of_a_frame(std::deque<InputEvent>& events) {
  using Kind = InputEvent::Kind;
  std::vector<InputEvent> taken;
  std::set<int> keys, buttons;
  bool wheel = false, character = false;
  while (!events.empty()) {
    const InputEvent event = events.front();
    // A held key can repeat faster than frames are drawn: each frame keeps one repeat and drops the others.
    if (event.kind == Kind::key && event.repeat && keys.contains(event.code)) {
      events.pop_front();
      continue;
    }
    // A key or button changes at most once per frame. Pointer moves after a button change wait, and so does
    // text after a key.
    if (event.kind == Kind::key && (keys.contains(event.code) || character)) break;
    if (event.kind == Kind::button && (buttons.contains(event.code) || wheel)) break;
    if ((event.kind == Kind::move || event.kind == Kind::wheel) && !buttons.empty()) break;
    if (event.kind == Kind::move && wheel) break;
    events.pop_front();
    taken.push_back(event);
    if (event.kind == Kind::key) keys.insert(event.code);
    if (event.kind == Kind::button) buttons.insert(event.code);
    if (event.kind == Kind::character) character = true;
    if (event.kind == Kind::wheel) wheel = true;
  }
  return taken;
}

}  // namespace collidoscope
