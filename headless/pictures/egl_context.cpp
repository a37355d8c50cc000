#include "headless/pictures/egl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>

#include "sim_cuda/core/error.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope {
namespace {

struct Candidate {
  EGLDeviceEXT device = nullptr;
  int number = 0;        // index in EGL's list
  int cuda_device = -1;  // from EGL_CUDA_DEVICE_NV
  bool software = false;
  int rank = 0;  // lower ranks are tried first
};

std::string egl_error() {
  switch (const EGLint code = eglGetError()) {
    case EGL_SUCCESS:
      return "no EGL error code";
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ACCESS:
      return "EGL_BAD_ACCESS";
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_CONTEXT:
      return "EGL_BAD_CONTEXT";
    case EGL_BAD_DISPLAY:
      return "EGL_BAD_DISPLAY";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH";
    case EGL_BAD_PARAMETER:
      return "EGL_BAD_PARAMETER";
    default:
      return "EGL error " + std::to_string(code);
  }
}

std::vector<Candidate> devices(int wanted_cuda_device) {
  std::vector<Candidate> found;
  EGLint count = 0;
  if (!eglQueryDevicesEXT(0, nullptr, &count) || count <= 0) return found;
  std::vector<EGLDeviceEXT> list(static_cast<std::size_t>(count));
  if (!eglQueryDevicesEXT(count, list.data(), &count)) return found;
  for (int i = 0; i < count; ++i) {
    Candidate candidate;
    candidate.device = list[static_cast<std::size_t>(i)];
    candidate.number = i;
    const char* text = eglQueryDeviceStringEXT(candidate.device, EGL_EXTENSIONS);
    const std::string extensions = text ? text : "";
    candidate.software = extensions.find("EGL_MESA_device_software") != std::string::npos;
    if (EGLAttrib number = -1; extensions.find("EGL_NV_device_cuda") != std::string::npos &&
                               eglQueryDeviceAttribEXT(candidate.device, EGL_CUDA_DEVICE_NV, &number))
      candidate.cuda_device = static_cast<int>(number);
    const bool wanted = wanted_cuda_device >= 0 && candidate.cuda_device == wanted_cuda_device;
    candidate.rank = wanted ? 0 : candidate.software ? 2 : 1;
    found.push_back(candidate);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.rank < b.rank; });
  return found;
}

}  // namespace

EglContext::EglContext(int cuda_device) {
  // libepoxy aborts the program if libEGL or an entry point is missing. Check for each one before use.
  if (!epoxy_has_egl())
    throw MachineError("EGL: libEGL is missing; install it (Debian: apt install libegl1)");
  const bool has_platforms = epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base");
  if (has_platforms && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") &&
      (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
       epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"))) {  // NVIDIA reports only the older
                                                                           // name
    const std::vector<Candidate> candidates = devices(cuda_device);
    const bool any_wanted = std::any_of(candidates.begin(), candidates.end(),
                                        [](const Candidate& candidate) { return candidate.rank == 0; });
    if (cuda_device >= 0 && !any_wanted)
      steps_down_.push_back("EGL: none of " + std::to_string(candidates.size()) + " devices is CUDA device " +
                            std::to_string(cuda_device));
    for (const Candidate& candidate : candidates) {
      const std::string name = "EGL device " + std::to_string(candidate.number);
      EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, candidate.device, nullptr);
      if (try_display(display, name)) {
        cuda_device_ = candidate.cuda_device;
        return;
      }
    }
    if (candidates.empty()) steps_down_.push_back("EGL: no device");
  } else {
    steps_down_.push_back("EGL: no device platform");
  }
  if (has_platforms && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA,
                                                  reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY), nullptr);
    if (try_display(display, "Mesa's surfaceless platform")) return;
  } else {
    steps_down_.push_back("EGL: no surfaceless platform");
  }
  std::string said;
  for (const std::string& line : steps_down_) said += (said.empty() ? "" : "; ") + line;
  throw MachineError("EGL: no OpenGL 4.5 context without a window: " + said);
}

bool EglContext::try_display(void* display, const std::string& name) {
  const auto fail = [&](const std::string& what) {
    steps_down_.push_back(name + ": " + what);
    return false;
  };
  if (display == EGL_NO_DISPLAY) return fail("no display, " + egl_error());
  EGLint major = 0, minor = 0;
  if (!eglInitialize(display, &major, &minor)) return fail("initialisation failed, " + egl_error());
  const auto give_up = [&](const std::string& what) {
    fail(what + ", " + egl_error());
    eglTerminate(display);
    return false;
  };
  if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context"))
    return give_up("no EGL_KHR_surfaceless_context");
  if (!eglBindAPI(EGL_OPENGL_API)) return give_up("no desktop OpenGL");
  EGLConfig config = EGL_NO_CONFIG_KHR;
  if (!epoxy_has_egl_extension(display, "EGL_KHR_no_config_context")) {
    const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLint count = 0;
    if (!eglChooseConfig(display, wanted, &config, 1, &count) || count < 1)
      return give_up("no configuration for desktop OpenGL");
  }
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               4,
                               EGL_CONTEXT_MINOR_VERSION,
                               5,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_NONE};
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) return give_up("no OpenGL 4.5 core context");
  if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    eglDestroyContext(display, context);
    return give_up("context cannot be made current");
  }
  display_ = display;
  context_ = context;
  gl::watch_errors();
  renderer_ = gl::renderer_name();
  version_ = gl::version_name();
  software_ = gl::is_software_renderer();
  return true;
}

EglContext::~EglContext() {
  if (!display_) return;
  if (eglGetCurrentContext() == context_)
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  // The display is not terminated. EGL has one per process, and another context may use it.
}

void EglContext::make_current() const {
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
    throw MachineError("EGL: context cannot be made current: " + egl_error());
}

}  // namespace collidoscope
