// ImGui 1.89 and later. Versions 1.87 and 1.88 also have AddKeyEvent(), with other names for the modifiers.
#include "viewer/gui_events.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#if IMGUI_VERSION_NUM >= 18900
#include <utility>

namespace collidoscope {
namespace {

constexpr std::pair<int, ImGuiKey> named_keys[] = {{GLFW_KEY_TAB, ImGuiKey_Tab},
                                                   {GLFW_KEY_LEFT, ImGuiKey_LeftArrow},
                                                   {GLFW_KEY_RIGHT, ImGuiKey_RightArrow},
                                                   {GLFW_KEY_UP, ImGuiKey_UpArrow},
                                                   {GLFW_KEY_DOWN, ImGuiKey_DownArrow},
                                                   {GLFW_KEY_PAGE_UP, ImGuiKey_PageUp},
                                                   {GLFW_KEY_PAGE_DOWN, ImGuiKey_PageDown},
                                                   {GLFW_KEY_HOME, ImGuiKey_Home},
                                                   {GLFW_KEY_END, ImGuiKey_End},
                                                   {GLFW_KEY_INSERT, ImGuiKey_Insert},
                                                   {GLFW_KEY_DELETE, ImGuiKey_Delete},
                                                   {GLFW_KEY_BACKSPACE, ImGuiKey_Backspace},
                                                   {GLFW_KEY_SPACE, ImGuiKey_Space},
                                                   {GLFW_KEY_ENTER, ImGuiKey_Enter},
                                                   {GLFW_KEY_KP_ENTER, ImGuiKey_KeypadEnter},
                                                   {GLFW_KEY_ESCAPE, ImGuiKey_Escape},
                                                   {GLFW_KEY_LEFT_SHIFT, ImGuiKey_LeftShift},
                                                   {GLFW_KEY_LEFT_CONTROL, ImGuiKey_LeftCtrl},
                                                   {GLFW_KEY_LEFT_ALT, ImGuiKey_LeftAlt},
                                                   {GLFW_KEY_LEFT_SUPER, ImGuiKey_LeftSuper},
                                                   {GLFW_KEY_RIGHT_SHIFT, ImGuiKey_RightShift},
                                                   {GLFW_KEY_RIGHT_CONTROL, ImGuiKey_RightCtrl},
                                                   {GLFW_KEY_RIGHT_ALT, ImGuiKey_RightAlt},
                                                   {GLFW_KEY_RIGHT_SUPER, ImGuiKey_RightSuper}};

ImGuiKey imgui_key(int code) {
  if (code >= GLFW_KEY_A && code <= GLFW_KEY_Z) return static_cast<ImGuiKey>(ImGuiKey_A + code - GLFW_KEY_A);
  for (const auto& [glfw_code, key] : named_keys)
    if (glfw_code == code) return key;
  return ImGuiKey_None;
}

}  // namespace

// Each frame handles all added events, since GuiInput already spreads them over frames.
GuiEvents::GuiEvents() { ImGui::GetIO().ConfigInputTrickleEventQueue = false; }

void GuiEvents::add(const InputEvent& event) {
  using Kind = InputEvent::Kind;
  ImGuiIO& io = ImGui::GetIO();
  switch (event.kind) {
    case Kind::key:
      if (event.code >= GLFW_KEY_LEFT_SHIFT && event.code <= GLFW_KEY_RIGHT_SUPER) {
        modifier_down_[event.code - GLFW_KEY_LEFT_SHIFT] = event.down;
        constexpr ImGuiKey modifiers[] = {ImGuiMod_Shift, ImGuiMod_Ctrl, ImGuiMod_Alt, ImGuiMod_Super};
        for (int i = 0; i < 4; ++i) io.AddKeyEvent(modifiers[i], modifier_down_[i] || modifier_down_[i + 4]);
      }
      if (const ImGuiKey key = imgui_key(event.code); key != ImGuiKey_None) io.AddKeyEvent(key, event.down);
      break;
    case Kind::character:
      io.AddInputCharacter(event.character);
      break;
    case Kind::button:
      if (event.code >= 0 && event.code < ImGuiMouseButton_COUNT)
        io.AddMouseButtonEvent(event.code, event.down);
      break;
    case Kind::move:
      io.AddMousePosEvent(static_cast<float>(event.x), static_cast<float>(event.y));
      break;
    case Kind::wheel:
      io.AddMouseWheelEvent(static_cast<float>(event.x), static_cast<float>(event.y));
      break;
    case Kind::focus:
      io.AddFocusEvent(event.down);
      if (!event.down)
        modifier_down_.fill(false);  // ImGui releases its keys: no release events follow a focus loss
      break;
  }
}

}  // namespace collidoscope

#endif
