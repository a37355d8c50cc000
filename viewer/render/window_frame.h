#pragma once
// A whole window's picture: the 3D view in its place, panels around and over it. Owns its framebuffer; needs
// the GL context that was current when it was made.

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

  /// Copies the renderer's picture to where its top left corner is (x, y); stretches it to `width` x `height`
  /// pixels where it has fewer.
  void place(const Renderer& renderer, int x, int y, int width, int height) const;
  void place(const Renderer& renderer, int x, int y) const {
    place(renderer, x, y, renderer.width(), renderer.height());
  }
  /// Panels are drawn into it.
  const gl::Target& target() const { return target_; }
  Image read() const;
  /// Copies it to the window's own framebuffer, which has `width` x `height` pixels.
  void present(int width, int height) const;

 private:
  gl::Target target_;
};

}  // namespace collidoscope
