// ImGui before 1.89, such as 1.86 in Debian 12: writes the state of keys and buttons into the IO.
#include "viewer/gui_events.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#if IMGUI_VERSION_NUM < 18900
#include <utility>

namespace collidoscope {

GuiEvents::GuiEvents() {
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
  for (const auto& [key, code] : keys) ImGui::GetIO().KeyMap[key] = code;
}

void GuiEvents::add(const InputEvent& event) {
  using Kind = InputEvent::Kind;
  ImGuiIO& io = ImGui::GetIO();
  switch (event.kind) {
    case Kind::key:
      if (event.code >= 0 && event.code < IM_ARRAYSIZE(io.KeysDown)) io.KeysDown[event.code] = event.down;
      if (event.code >= GLFW_KEY_LEFT_SHIFT && event.code <= GLFW_KEY_RIGHT_SUPER)
        modifier_down_[event.code - GLFW_KEY_LEFT_SHIFT] = event.down;
      io.KeyShift = modifier_down_[0] || modifier_down_[4];
      io.KeyCtrl = modifier_down_[1] || modifier_down_[5];
      io.KeyAlt = modifier_down_[2] || modifier_down_[6];
      io.KeySuper = modifier_down_[3] || modifier_down_[7];
      break;
    case Kind::character:
      io.AddInputCharacter(event.character);
      break;
    case Kind::button:
      if (event.code >= 0 && event.code < IM_ARRAYSIZE(io.MouseDown)) io.MouseDown[event.code] = event.down;
      break;
    case Kind::move:
      io.MousePos = {static_cast<float>(event.x), static_cast<float>(event.y)};
      break;
    case Kind::wheel:
      io.MouseWheelH += static_cast<float>(event.x);
      io.MouseWheel += static_cast<float>(event.y);
      break;
    case Kind::focus:
      io.AddFocusEvent(event.down);
      if (event.down) break;
      // No release events follow a focus loss.
      for (bool& down : io.KeysDown) down = false;
      modifier_down_.fill(false);
      break;
  }
}

}  // namespace collidoscope

#endif
