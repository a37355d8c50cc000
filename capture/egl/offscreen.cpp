#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <collidoscope/offscreen.h>
#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

namespace collidoscope::capture {

struct OffscreenContext::Parts {
  int width = 0, height = 0;
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  std::string renderer;
  PFNGLREADPIXELSPROC read_pixels = nullptr;

  ~Parts() {
    if (context != EGL_NO_CONTEXT) {
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(display, context);
    }
    if (display != EGL_NO_DISPLAY) eglTerminate(display);
  }
};

namespace {

template <class Type>
Type egl_function(const char* name) {
  return reinterpret_cast<Type>(eglGetProcAddress(name));
}

/// Displays without a window system: of each device, then Mesa's.
std::vector<EGLDisplay> displays() {
  std::vector<EGLDisplay> all;
  const auto display_of = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  const auto devices_of = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  if (display_of == nullptr) return all;
  std::array<EGLDeviceEXT, 32> devices{};
  EGLint count = 0;
  if (devices_of != nullptr && devices_of(static_cast<EGLint>(devices.size()), devices.data(), &count))
    for (int k = 0; k < count; ++k)
      all.push_back(display_of(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(k)], nullptr));
  all.push_back(display_of(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  return all;
}

/// Makes a context current. Returns an empty text, or what failed.
std::string try_display(EGLDisplay display, EGLContext& context) {
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return "no display";
  if (!eglBindAPI(EGL_OPENGL_API)) return "no OpenGL";
  constexpr std::array<EGLint, 3> wanted{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  const bool has_config = eglChooseConfig(display, wanted.data(), &config, 1, &count) && count > 0;
  constexpr std::array<EGLint, 7> version{EGL_CONTEXT_MAJOR_VERSION,
                                          3,
                                          EGL_CONTEXT_MINOR_VERSION,
                                          3,
                                          EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                          EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                          EGL_NONE};
  context =
      eglCreateContext(display, has_config ? config : EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, version.data());
  if (context == EGL_NO_CONTEXT) return "no core context of OpenGL 3.3";
  if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return "";
  eglDestroyContext(display, context);
  context = EGL_NO_CONTEXT;
  return "no context without a surface";
}

/// "llvmpipe, Mesa 22.3.6" of "llvmpipe (LLVM 15.0.6, 256 bits)" and "4.5 (Core Profile) Mesa 22.3.6".
std::string renderer_of(const std::string& renderer, const std::string& version) {
  const std::size_t mesa = version.find("Mesa ");
  return renderer.substr(0, renderer.find(" (")) + ", " +
         (mesa == version.npos ? version : version.substr(mesa, version.find(' ', mesa + 5) - mesa));
}

}  // namespace

OffscreenContext::OffscreenContext(int width, int height) : parts_(std::make_unique<Parts>()) {
  parts_->width = width;
  parts_->height = height;
  std::string tried;
  for (EGLDisplay display : displays()) {
    const std::string fault = try_display(display, parts_->context);
    if (fault.empty()) {
      parts_->display = display;
      break;
    }
    tried += (tried.empty() ? "" : "; ") + fault;
  }
  if (parts_->display == EGL_NO_DISPLAY)
    throw std::runtime_error("no OpenGL context without a window: " +
                             (tried.empty() ? "no EGL display" : tried));
  const auto string_of = egl_function<PFNGLGETSTRINGPROC>("glGetString");
  const auto text = [&](GLenum name) { return std::string(reinterpret_cast<const char*>(string_of(name))); };
  parts_->renderer = renderer_of(text(GL_RENDERER), text(GL_VERSION));
  parts_->read_pixels = egl_function<PFNGLREADPIXELSPROC>("glReadPixels");

  std::array<GLuint, 2> buffers{};
  GLuint framebuffer = 0;
  egl_function<PFNGLGENRENDERBUFFERSPROC>("glGenRenderbuffers")(2, buffers.data());
  egl_function<PFNGLGENFRAMEBUFFERSPROC>("glGenFramebuffers")(1, &framebuffer);
  egl_function<PFNGLBINDFRAMEBUFFERPROC>("glBindFramebuffer")(GL_FRAMEBUFFER, framebuffer);
  const auto attach = [&](GLuint buffer, GLenum format, GLenum place) {
    egl_function<PFNGLBINDRENDERBUFFERPROC>("glBindRenderbuffer")(GL_RENDERBUFFER, buffer);
    egl_function<PFNGLRENDERBUFFERSTORAGEPROC>("glRenderbufferStorage")(GL_RENDERBUFFER, format, width,
                                                                        height);
    egl_function<PFNGLFRAMEBUFFERRENDERBUFFERPROC>("glFramebufferRenderbuffer")(GL_FRAMEBUFFER, place,
                                                                                GL_RENDERBUFFER, buffer);
  };
  attach(buffers[0], GL_RGBA8, GL_COLOR_ATTACHMENT0);
  attach(buffers[1], GL_DEPTH24_STENCIL8, GL_DEPTH_STENCIL_ATTACHMENT);
  if (egl_function<PFNGLCHECKFRAMEBUFFERSTATUSPROC>("glCheckFramebufferStatus")(GL_FRAMEBUFFER) !=
      GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error("OpenGL: no framebuffer of " + std::to_string(width) + "x" +
                             std::to_string(height) + " pixels");
  egl_function<PFNGLVIEWPORTPROC>("glViewport")(0, 0, width, height);
}

OffscreenContext::~OffscreenContext() = default;

const std::string& OffscreenContext::renderer() const { return parts_->renderer; }

OffscreenContext::Function OffscreenContext::function(const char* name) const {
  return eglGetProcAddress(name);
}

Picture OffscreenContext::read() const {
  const auto row = static_cast<std::ptrdiff_t>(parts_->width) * 4;
  Picture picture{parts_->width, parts_->height, {}};
  picture.rgba.resize(static_cast<std::size_t>(row * parts_->height));
  parts_->read_pixels(0, 0, parts_->width, parts_->height, GL_RGBA, GL_UNSIGNED_BYTE, picture.rgba.data());
  // OpenGL has the bottom row first.
  for (auto low = picture.rgba.begin(), high = picture.rgba.end() - row; low < high; low += row, high -= row)
    std::swap_ranges(low, low + row, high);
  return picture;
}

}  // namespace collidoscope::capture
