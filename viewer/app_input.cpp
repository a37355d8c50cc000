// Mouse and keyboard input for camera, run and selection, unless ImGui captures it.

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "viewer/app.h"
#include "viewer/view/camera_control.h"

namespace collidoscope {

void App::handle(const InputEvent& event) {
  switch (event.kind) {
    case InputEvent::Kind::key:
      handle_key(event);
      break;
    case InputEvent::Kind::button:
      handle_button(event);
      break;
    case InputEvent::Kind::move:
      handle_move(event);
      break;
    case InputEvent::Kind::wheel: {
      if (ImGui::GetIO().WantCaptureMouse) break;
      const ScreenRect& at = workspace_.scene_view;
      const double size = scene_.scene_size();
      zoom(scene_.camera(), event.y, mouse_x_ - static_cast<double>(at.x),
           mouse_y_ - static_cast<double>(at.y), static_cast<double>(at.width),
           static_cast<double>(at.height), 1e-5 * size, 30 * size);
      scene_.camera_was_moved();
      workspace_.hint = false;
      break;
    }
    case InputEvent::Kind::focus:
      if (!event.down) keys_.clear();
      break;
    case InputEvent::Kind::character:
      break;
  }
}

void App::handle_key(const InputEvent& event) {
  if (!event.down) {
    keys_.erase(event.code);
    return;
  }
  if (ImGui::GetIO().WantCaptureKeyboard || ImGui::GetIO().WantTextInput) return;
  keys_.insert(event.code);
  const bool flying = buttons_.contains(GLFW_MOUSE_BUTTON_RIGHT);
  const bool again = event.repeat;
  workspace_.hint = false;
  switch (event.code) {
    case GLFW_KEY_SPACE:
      if (again) break;
      if (event.modifiers & GLFW_MOD_SHIFT)
        workspace_.play_or_pause_backwards();
      else
        workspace_.play_or_pause();
      break;
    case GLFW_KEY_S:
      if (event.modifiers & GLFW_MOD_CONTROL) {
        workspace_.recording_requested |= !again;
        break;
      }
      if (flying) break;
      if (event.modifiers & GLFW_MOD_SHIFT) {
        workspace_.request_state(run_.stats.step - 1);
      } else {
        workspace_.request_step(again);
      }
      break;
    case GLFW_KEY_LEFT_BRACKET:
    case GLFW_KEY_RIGHT_BRACKET:
      go_to_mark(event.code == GLFW_KEY_RIGHT_BRACKET);
      break;
    case GLFW_KEY_R:
      workspace_.restart_requested |= !again;
      break;
    case GLFW_KEY_F:
      workspace_.camera_request =
          event.modifiers & GLFW_MOD_SHIFT ? CameraRequest::frame_all : CameraRequest::frame_selection;
      break;
    case GLFW_KEY_1:
    case GLFW_KEY_KP_1:
      workspace_.camera_request = CameraRequest::front;
      break;
    case GLFW_KEY_3:
    case GLFW_KEY_KP_3:
      workspace_.camera_request = CameraRequest::side;
      break;
    case GLFW_KEY_7:
    case GLFW_KEY_KP_7:
      workspace_.camera_request = CameraRequest::top;
      break;
    case GLFW_KEY_5:
    case GLFW_KEY_KP_5:
      if (!again) workspace_.camera_request = CameraRequest::orthographic;
      break;
    case GLFW_KEY_B:
      workspace_.projectile_requested |= !again;
      break;
    case GLFW_KEY_DELETE:
      workspace_.removal_requested |= !again;
      break;
    case GLFW_KEY_C:
      if (!again) workspace_.visible_panels.convergence = !workspace_.visible_panels.convergence;
      break;
    case GLFW_KEY_P:
      workspace_.screenshot_requested |= !again;
      break;
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
      if (event.modifiers & GLFW_MOD_CONTROL) workspace_.scale_font(1.1f);
      break;
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
      if (event.modifiers & GLFW_MOD_CONTROL) workspace_.scale_font(1 / 1.1f);
      break;
    case GLFW_KEY_0:
    case GLFW_KEY_KP_0:
      if (event.modifiers & GLFW_MOD_CONTROL) workspace_.font_scale = 1;
      break;
    case GLFW_KEY_F1:
      if (!again) workspace_.help = !workspace_.help;
      break;
    case GLFW_KEY_ESCAPE:
      if (ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup)) break;  // Escape closes the popup
      if (std::exchange(workspace_.columns.open, false)) break;
      if (work_in_progress_ || presimulating_) {
        cancel_work();
        break;
      }
      if (measuring_) {
        stop_measurements();
        break;
      }
      workspace_.help = false;
      workspace_.selection.reset();
      workspace_.tree.node.reset();
      workspace_.follow = false;
      break;
    case GLFW_KEY_TAB: {
      PanelVisibility& visible_panels = workspace_.visible_panels;
      if (!again)
        visible_panels.left = visible_panels.right = visible_panels.bottom =
            !(visible_panels.left || visible_panels.right || visible_panels.bottom);
      break;
    }
    default:
      break;
  }
}

void App::handle_button(const InputEvent& event) {
  if (event.down) {
    if (ImGui::GetIO().WantCaptureMouse) return;
    buttons_.insert(event.code);
    moved_ = 0;
    workspace_.hint = false;
    workspace_.pressed = "scene";
    return;
  }
  const bool was_ours = buttons_.erase(event.code) > 0;
  constexpr double click = 4;  // pixels of pointer movement within a click
  if (!was_ours || event.code != GLFW_MOUSE_BUTTON_LEFT || moved_ > click) return;
  const ScreenRect& at = workspace_.scene_view;
  const SceneView::Picked picked = scene_.pick(static_cast<int>(mouse_x_ - static_cast<double>(at.x)),
                                               static_cast<int>(mouse_y_ - static_cast<double>(at.y)));
  workspace_.selection = picked.body;
  workspace_.tree.node.reset();
  if (!picked.body) workspace_.follow = false;
  if (!picked.box || tree_.view() == nullptr)
    return;                    // nodes are selectable only while the tree panel is open
  workspace_.playing = false;  // the next state has another tree
  const std::vector<std::int64_t>& sizes = run_.level_sizes;
  std::int64_t place = *picked.box;
  for (int level = 0; level < std::min(workspace_.layers.first_level, static_cast<int>(sizes.size()));
       ++level)
    place += sizes[static_cast<std::size_t>(level)];
  workspace_.tree.node = static_cast<std::uint32_t>(place);
}

void App::handle_move(const InputEvent& event) {
  const double dx = event.x - mouse_x_, dy = event.y - mouse_y_;
  mouse_x_ = event.x;
  mouse_y_ = event.y;
  if (buttons_.empty()) return;
  moved_ += std::hypot(dx, dy);
  scene_.camera_was_moved();
  const double height = static_cast<double>(workspace_.scene_view.height);
  if (buttons_.contains(GLFW_MOUSE_BUTTON_LEFT))
    orbit(scene_.camera(), dx, dy, height);
  else if (keys_.contains(GLFW_KEY_W) || keys_.contains(GLFW_KEY_S) || keys_.contains(GLFW_KEY_A) ||
           keys_.contains(GLFW_KEY_D))
    look(scene_.camera(), dx, dy, height);
  else
    pan(scene_.camera(), dx, dy, height);
}

/// Requests the nearest state with a mark after or before the shown one.
void App::go_to_mark(bool after) {
  if (!run_.timeline) return;
  std::optional<std::int64_t> state;
  for (const TimelineMark& mark : run_.timeline->marks) {
    if (after ? mark.state <= run_.stats.step : mark.state >= run_.stats.step) continue;
    state = mark.state;
    if (after) break;
  }
  if (state)
    workspace_.request_state(*state);
  else
    show_notice(after ? "no mark after this state" : "no mark before this state");
}

void App::fly_camera(double seconds) {
  if (!buttons_.contains(GLFW_MOUSE_BUTTON_RIGHT)) return;
  const auto axis = [&](int more, int less) {
    return (keys_.contains(more) ? 1.0 : 0.0) - (keys_.contains(less) ? 1.0 : 0.0);
  };
  const Vector3d direction(axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q),
                           axis(GLFW_KEY_W, GLFW_KEY_S));
  if (direction.isZero()) return;
  scene_.camera_was_moved();
  fly(scene_.camera(), direction * (0.25 * scene_.scene_size() * seconds));
}

}  // namespace collidoscope
