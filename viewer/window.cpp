#include "viewer/window.h"

#include <GLFW/glfw3.h>

#include "sim_cuda/core/error.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope {
namespace {

std::string glfw_error() {
  const char* words = nullptr;
  glfwGetError(&words);
  return words ? words : "unknown GLFW error";
}

/// Prefers X11 (XWayland in a Wayland session), since the tests of the window run there. Else Wayland. GLFW
/// 3.3 supports only one of them; GLFW 3.4 would prefer Wayland.
bool start_glfw() {
#ifdef GLFW_PLATFORM
  glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
  if (glfwInit()) return true;
  glfwInitHint(GLFW_PLATFORM, GLFW_ANY_PLATFORM);
#endif
  return glfwInit() == GLFW_TRUE;
}

}  // namespace

Window::Window(int width, int height, const std::string& title) {
  if (!start_glfw())
    throw MachineError("no window: " + glfw_error() + "; use collidoscope-headless without a display");
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);  // all drawing uses own framebuffers
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (!window_) {
    const std::string why = glfw_error();
    glfwTerminate();
    throw MachineError("no window with OpenGL 4.5: " + why);
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetWindowSizeLimits(window_, 320, 240, GLFW_DONT_CARE, GLFW_DONT_CARE);
  try {
    gl::watch_errors();
  } catch (const MachineError&) {
    glfwDestroyWindow(window_);
    glfwTerminate();
    throw;
  }
  install_callbacks();
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

Window& Window::of(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }

void Window::install_callbacks() {
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int modifiers) {
    InputEvent event{InputEvent::Kind::key};
    event.code = key;
    event.down = action != GLFW_RELEASE;
    event.repeat = action == GLFW_REPEAT;
    event.modifiers = modifiers;
    of(w).events_.push_back(event);
  });
  glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned character) {
    InputEvent event{InputEvent::Kind::character};
    event.character = character;
    of(w).events_.push_back(event);
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int modifiers) {
    InputEvent event{InputEvent::Kind::button};
    event.code = button;
    event.down = action == GLFW_PRESS;
    event.modifiers = modifiers;
    of(w).events_.push_back(event);
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) {
    // GLFW uses window units, which differ from pixels on some displays.
    int window_width = 0, window_height = 0;
    glfwGetWindowSize(w, &window_width, &window_height);
    InputEvent event{InputEvent::Kind::move};
    event.x = window_width > 0 ? x * of(w).width() / window_width : x;
    event.y = window_height > 0 ? y * of(w).height() / window_height : y;
    of(w).events_.push_back(event);
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double x, double y) {
    InputEvent event{InputEvent::Kind::wheel};
    event.x = x;
    event.y = y;
    of(w).events_.push_back(event);
  });
  glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
    of(w).dropped_files_.assign(paths, paths + count);
  });
  glfwSetWindowFocusCallback(window_, [](GLFWwindow* w, int gained) {
    InputEvent event{InputEvent::Kind::focus};
    event.down = gained != 0;
    of(w).events_.push_back(event);
  });
}

bool Window::closing() const { return glfwWindowShouldClose(window_) != 0; }

void Window::poll(double wait_seconds) {
  if (wait_seconds > 0)
    glfwWaitEventsTimeout(wait_seconds);
  else
    glfwPollEvents();
}

void Window::wake() { glfwPostEmptyEvent(); }

void Window::swap() { glfwSwapBuffers(window_); }

int Window::width() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return width;
}

int Window::height() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return height;
}

float Window::content_scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return x > 0 ? x : 1;
}

std::string Window::clipboard() const {
  const char* text = glfwGetClipboardString(window_);
  return text ? text : "";
}

void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

void Window::set_clipboard(const std::string& text) { glfwSetClipboardString(window_, text.c_str()); }

}  // namespace collidoscope
