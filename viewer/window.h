#pragma once
// A GLFW window with an OpenGL 4.5 context, current on this thread, and its ordered input events. Owns both;
// only one instance at a time.

#include <deque>
#include <string>
#include <vector>

struct GLFWwindow;

namespace collidoscope {

/// A mouse, keyboard or focus event. Positions are in pixels of the framebuffer.
struct InputEvent {
  enum class Kind { key, character, button, move, wheel, focus } kind;
  int code = 0;         ///< GLFW code of the key or button
  bool down = false;    ///< key, button: pressed; focus: gained
  bool repeat = false;  ///< repeat of a held key
  int modifiers = 0;    ///< GLFW modifier bits of a key or button event
  unsigned character = 0;
  double x = 0, y = 0;  ///< move: position; wheel: distance
};

class Window {
 public:
  /// Throws MachineError if there is no display or no OpenGL 4.5.
  Window(int width, int height, const std::string& title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Whether the user requested to close the window.
  bool closing() const;
  /// Collects new events. Returns at once, or with `wait_seconds`, when an event arrives.
  void poll(double wait_seconds = 0);
  /// Ends a poll() that waits. Any thread, while a Window exists.
  static void wake();
  void swap();
  /// Pixels of the framebuffer; 0 if minimised.
  int width() const;
  int height() const;
  /// Text scale that the display recommends.
  float content_scale() const;

  std::deque<InputEvent>& events() { return events_; }
  /// Paths of files that were dropped on the window.
  const std::vector<std::string>& dropped_files() const { return dropped_files_; }
  void forget_dropped_files() { dropped_files_.clear(); }
  void set_title(const std::string& title);
  std::string clipboard() const;
  void set_clipboard(const std::string& text);

 private:
  static Window& of(GLFWwindow* window);
  void install_callbacks();

  GLFWwindow* window_ = nullptr;
  std::deque<InputEvent> events_;
  std::vector<std::string> dropped_files_;
};

}  // namespace collidoscope
