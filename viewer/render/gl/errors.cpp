#include "viewer/render/gl/errors.h"

#include <epoxy/gl.h>

#include <utility>

#include "sim_cuda/core/error.h"

namespace collidoscope::gl {
namespace {

thread_local std::string
    first_error;  // stored until check(), since an exception must not pass through the driver

void GLAPIENTRY on_message(GLenum, GLenum type, GLuint, GLenum, GLsizei length, const GLchar* message,
                           const void*) {
  if (type != GL_DEBUG_TYPE_ERROR || !first_error.empty()) return;
  first_error = length < 0 ? std::string(message) : std::string(message, static_cast<std::size_t>(length));
  while (!first_error.empty() && first_error.back() == '\n') first_error.pop_back();
}

const char* error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    default:
      return "unknown error";
  }
}

std::string get_string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "unknown";
}

}  // namespace

void watch_errors() {
  if (epoxy_gl_version() < 45)
    throw MachineError("OpenGL 4.5 is required; this machine provides " + version_name() + " (" +
                       renderer_name() + ")");
  first_error.clear();
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(on_message, nullptr);
  glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, nullptr, GL_FALSE);
  glDebugMessageControl(GL_DONT_CARE, GL_DEBUG_TYPE_ERROR, GL_DONT_CARE, 0, nullptr, GL_TRUE);
  check("enable error reports");
}

void check(const std::string& what) {
  // A driver may omit messages in a context without the debug flag, but glGetError() always reports.
  std::string error = std::exchange(first_error, {});
  for (GLenum code = glGetError(); code != GL_NO_ERROR; code = glGetError()) {
    if (error.empty()) error = error_name(code);
    if (code == GL_CONTEXT_LOST) break;
  }
  if (!error.empty()) throw MachineError("OpenGL: cannot " + what + ": " + error);
}

void forget_errors() {
  first_error.clear();
  while (glGetError() != GL_NO_ERROR) continue;
}

std::string renderer_name() { return get_string(GL_RENDERER); }
std::string version_name() { return get_string(GL_VERSION); }

bool is_software_renderer() {
  const std::string name = renderer_name();
  for (const char* software : {"llvmpipe", "softpipe", "swrast", "Software Rasterizer", "SwiftShader"})
    if (name.find(software) != std::string::npos) return true;
  return false;
}

}  // namespace collidoscope::gl
