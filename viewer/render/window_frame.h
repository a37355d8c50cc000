#pragma once
// The picture of the whole window: the 3D view, with panels around and over it. Owns its framebuffer.
// Requires the GL context of its construction.

#include "viewer/render/gl/target.h"
#include "viewer/render/image.h"
#include "viewer/render/renderer.h"

namespace collidoscope {

class WindowFrame {
 public:
  WindowFrame(int width, int height);
  void resize(int width, int height);
  int width() const { return target_.width(); }
  int height() const { return target_.height(); }

  /// Copies the renderer's picture to (x, y), its top left corner. A smaller picture is scaled up to `width`
  /// x `height` pixels.
  void place(const Renderer& renderer, int x, int y, int width, int height) const;
  void place(const Renderer& renderer, int x, int y) const {
    place(renderer, x, y, renderer.width(), renderer.height());
  }
  /// Target for the panels.
  const gl::Target& target() const { return target_; }
  Image read() const;
  /// Copies the picture to the window's framebuffer of `width` x `height` pixels.
  void present(int width, int height) const;

 private:
  gl::Target target_;
};

}  // namespace collidoscope
