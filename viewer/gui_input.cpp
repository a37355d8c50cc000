#include "viewer/gui_input.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <utility>

namespace collidoscope {

GuiInput::GuiInput(Window& window) : window_(window) {
  ImGuiIO& io = ImGui::GetIO();
  static constexpr std::pair<ImGuiKey, int> keys[] = {{ImGuiKey_Tab, GLFW_KEY_TAB},
                                                      {ImGuiKey_LeftArrow, GLFW_KEY_LEFT},
                                                      {ImGuiKey_RightArrow, GLFW_KEY_RIGHT},
                                                      {ImGuiKey_UpArrow, GLFW_KEY_UP},
                                                      {ImGuiKey_DownArrow, GLFW_KEY_DOWN},
                                                      {ImGuiKey_PageUp, GLFW_KEY_PAGE_UP},
                                                      {ImGuiKey_PageDown, GLFW_KEY_PAGE_DOWN},
                                                      {ImGuiKey_Home, GLFW_KEY_HOME},
                                                      {ImGuiKey_End, GLFW_KEY_END},
                                                      {ImGuiKey_Insert, GLFW_KEY_INSERT},
                                                      {ImGuiKey_Delete, GLFW_KEY_DELETE},
                                                      {ImGuiKey_Backspace, GLFW_KEY_BACKSPACE},
                                                      {ImGuiKey_Space, GLFW_KEY_SPACE},
                                                      {ImGuiKey_Enter, GLFW_KEY_ENTER},
                                                      {ImGuiKey_KeyPadEnter, GLFW_KEY_KP_ENTER},
                                                      {ImGuiKey_Escape, GLFW_KEY_ESCAPE},
                                                      {ImGuiKey_A, GLFW_KEY_A},
                                                      {ImGuiKey_C, GLFW_KEY_C},
                                                      {ImGuiKey_V, GLFW_KEY_V},
                                                      {ImGuiKey_X, GLFW_KEY_X},
                                                      {ImGuiKey_Y, GLFW_KEY_Y},
                                                      {ImGuiKey_Z, GLFW_KEY_Z}};
  for (const auto& [key, code] : keys) io.KeyMap[key] = code;
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
  using Kind = InputEvent::Kind;
  ImGuiIO& io = ImGui::GetIO();
  std::vector<InputEvent> taken;
  std::set<int> keys, buttons;
  bool wheel = false, character = false;
  std::deque<InputEvent>& events = window_.events();
  while (!events.empty()) {
    const InputEvent event = events.front();
    // A key or button changes once in a frame; the pointer does not move on after a button changed, nor text
    // come after a key that acts on it.
    if (event.kind == Kind::key && (keys.contains(event.code) || character)) break;
    if (event.kind == Kind::character && !keys.empty() && character) break;
    if (event.kind == Kind::button && (buttons.contains(event.code) || wheel)) break;
    if ((event.kind == Kind::move || event.kind == Kind::wheel) && !buttons.empty()) break;
    if (event.kind == Kind::move && wheel) break;
    events.pop_front();
    taken.push_back(event);
    switch (event.kind) {
      case Kind::key:
        keys.insert(event.code);
        if (event.code >= 0 && event.code < IM_ARRAYSIZE(io.KeysDown)) io.KeysDown[event.code] = event.down;
        io.KeyCtrl = io.KeysDown[GLFW_KEY_LEFT_CONTROL] || io.KeysDown[GLFW_KEY_RIGHT_CONTROL];
        io.KeyShift = io.KeysDown[GLFW_KEY_LEFT_SHIFT] || io.KeysDown[GLFW_KEY_RIGHT_SHIFT];
        io.KeyAlt = io.KeysDown[GLFW_KEY_LEFT_ALT] || io.KeysDown[GLFW_KEY_RIGHT_ALT];
        io.KeySuper = io.KeysDown[GLFW_KEY_LEFT_SUPER] || io.KeysDown[GLFW_KEY_RIGHT_SUPER];
        break;
      case Kind::character:
        character = true;
        io.AddInputCharacter(event.character);
        break;
      case Kind::button:
        buttons.insert(event.code);
        if (event.code >= 0 && event.code < IM_ARRAYSIZE(io.MouseDown)) io.MouseDown[event.code] = event.down;
        break;
      case Kind::move:
        io.MousePos = {static_cast<float>(event.x), static_cast<float>(event.y)};
        break;
      case Kind::wheel:
        wheel = true;
        io.MouseWheelH += static_cast<float>(event.x);
        io.MouseWheel += static_cast<float>(event.y);
        break;
      case Kind::focus:
        io.AddFocusEvent(event.down);
        if (!event.down)  // releases are not reported to a window that lost the keyboard
          for (bool& down : io.KeysDown) down = false;
        break;
    }
  }
  return taken;
}

}  // namespace collidoscope
