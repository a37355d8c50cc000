#pragma once
// The window: a GLFW window with an OpenGL 4.5 context, current on this thread, and the events that came to
// it, in order. Owns both; one at a time.

#include <deque>
#include <string>

struct GLFWwindow;

namespace collidoscope {

/// What came from the mouse or the keyboard. Places are in pixels of the framebuffer.
struct InputEvent {
  enum class Kind { key, character, button, move, wheel, focus } kind;
  int code = 0;         ///< GLFW's key or button
  bool down = false;    ///< of key and button: pressed; of focus: gained
  bool repeat = false;  ///< of key: held
  int modifiers = 0;    ///< GLFW's, with key and button
  unsigned character = 0;
  double x = 0, y = 0;  ///< of move: where to; of wheel: how far
};

class Window {
 public:
  /// Throws MachineError where there is no display or no OpenGL 4.5.
  Window(int width, int height, const std::string& title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Whether the user asked for its end.
  bool closing() const;
  /// Takes in what came since; returns at once, or, with `wait_seconds`, when something came.
  void poll(double wait_seconds = 0);
  void swap();
  /// Pixels of the framebuffer; 0 where it is minimised.
  int width() const;
  int height() const;
  /// Of the display: how much larger text should be.
  float content_scale() const;

  std::deque<InputEvent>& events() { return events_; }
  std::string clipboard() const;
  void set_clipboard(const std::string& text);

 private:
  static Window& of(GLFWwindow* window);
  void install_callbacks();

  GLFWwindow* window_ = nullptr;
  std::deque<InputEvent> events_;
};

}  // namespace collidoscope
