#pragma once
// An OpenGL context without a window, for picture tests. It runs on a GPU or on Mesa's software renderer, and
// needs neither X nor Wayland. Link collidoscope::offscreen.

#include <collidoscope/picture.h>
#include <memory>
#include <string>

namespace collidoscope::capture {

class OffscreenContext {
 public:
  /// Makes a core context of OpenGL 3.3 or later current, and binds a framebuffer of RGBA8 with depth and
  /// stencil. Throws std::runtime_error, with what was tried.
  OffscreenContext(int width, int height);
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// "llvmpipe, Mesa 22.3.6": for Settings::renderer.
  const std::string& renderer() const;
  /// An OpenGL function, or null.
  using Function = void (*)();
  Function function(const char* name) const;
  /// The pixels of the framebuffer, rows from the top.
  Picture read() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace collidoscope::capture
